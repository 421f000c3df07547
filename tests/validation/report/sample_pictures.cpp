#include <fmt/format.h>

#include <random>
#include <string>
#include <vector>

#include "tests/validation/report/sample_results.h"
#include "tests/validation/report/sample_shapes.h"
#include "validation/pictures.h"

namespace talus::testing {
namespace {

using nlohmann::json;

/// Items of a made-up collapse: they spread with the deposit.
analysis::SnapshotSeries column_series(const Shape& shape) {
  const bool continuum = is_continuum(shape.code);
  std::mt19937 random(static_cast<unsigned>(shape.seed));
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const int count = continuum ? 2000 : 1072;
  std::vector<double> x(count), z(count), y(count);
  for (int i = 0; i < count; ++i) {
    x[i] = unit(random);
    z[i] = unit(random);
    y[i] = 0.012 * unit(random);
  }
  analysis::SnapshotSeries series;
  for (int frame = 0; frame <= 24; ++frame) {
    const double time = run_time * frame / 24, done = done_at(time);
    analysis::Snapshot snapshot{time, analysis::Vectors(3, count), analysis::Vectors::Zero(3, count),
                                Eigen::VectorXd::Constant(count, continuum ? 7.7e-9 : 1.4e-8)};
    for (int i = 0; i < count; ++i) {
      const double place = x[i] * (1.0 + shape.runout * done * x[i]);
      snapshot.positions.col(i) << column_length * place, y[i],
          column_length * z[i] * depth(shape, place, done) + 0.001;
      snapshot.velocities(0, i) =
          column_length * shape.runout * x[i] * x[i] * (2.0 * time / 0.0144) * (1.0 - done);
    }
    series.push_back(snapshot);
  }
  return series;
}

}  // namespace

json sample_pictures() {
  json pictures = json::array();
  for (const Shape& shape : shapes) {
    const std::string code = shape.code;
    if (shape.seed != 1 || code == "continuum_coarse" || code == "continuum_short_steps") continue;
    validation::PictureOptions options;
    options.name = "column_collapse/a_1";
    options.code = code;
    options.seed = 1;
    options.thickness = 0.012;
    options.field_spacing = column_length / 16;
    if (is_continuum(code)) options.packing = 0.57;
    pictures.push_back(validation::picture_of_series(column_series(shape), options));
  }
  return pictures;
}

json many_pictures(int count) {
  json pictures = sample_pictures();
  const json first = pictures;
  for (int k = 3; k < count; ++k) {
    for (json picture : first) {
      picture["name"] = fmt::format("column_collapse/copy_{}", k);
      pictures.push_back(picture);
    }
  }
  return pictures;
}

}  // namespace talus::testing
