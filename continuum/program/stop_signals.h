// A wish to stop, by SIGINT or SIGTERM, that a run sees between two steps.
#pragma once

#include <array>
#include <csignal>

namespace talus {

/// While it lives, the two signals ask instead of ending the process; ignored ones (nohup) stay ignored.
class StopSignals {
 public:
  StopSignals() {
    received() = 0;
    for (std::size_t i = 0; i < signals.size(); ++i) {
      before_[i] = std::signal(signals[i], [](int signal) { received() = signal; });
      if (before_[i] == SIG_IGN) std::signal(signals[i], SIG_IGN);
    }
  }
  ~StopSignals() {
    for (std::size_t i = 0; i < signals.size(); ++i) std::signal(signals[i], before_[i]);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// The last of them that came; 0 when none did.
  static volatile std::sig_atomic_t& received() {
    static volatile std::sig_atomic_t signal = 0;
    return signal;
  }

 private:
  static constexpr std::array<int, 2> signals{SIGINT, SIGTERM};
  std::array<void (*)(int), 2> before_{};
};

}  // namespace talus
