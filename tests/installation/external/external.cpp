#include <cstdio>

#include <continuum/scene/scene.h>

int main(int, char** arguments) {
  const talus::Scene scene = talus::read_scene(arguments[1]);
  talus::State state = talus::initial_state(scene);
  while (state.time < 0.02) talus::step(state, scene.settings, 0.005);
  std::printf("%ld particles at %g s\n", static_cast<long>(state.particles.count()), state.time);
}
