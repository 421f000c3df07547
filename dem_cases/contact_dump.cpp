#include "dem_cases/contact_dump.h"

#include <cmath>
#include <utility>

#include "dem_cases/container.h"
#include "dem_cases/dump_reader.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/time_step.h"

namespace talus::dem {
namespace {

using analysis::GrainContact;

/// One line as it stands: ids count from 1.
struct Line {
  Eigen::Vector3d first, second, force;
  std::int64_t first_id, second_id;
};

Line read_line(DumpReader& reader) {
  auto rest = reader.line();
  Line line;
  for (double& value : line.first) value = reader.next<double>(rest);
  for (double& value : line.second) value = reader.next<double>(rest);
  line.first_id = reader.next<std::int64_t>(rest);
  line.second_id = reader.next<std::int64_t>(rest);
  for (double& value : line.force) value = reader.next<double>(rest);
  if (!line.first.allFinite() || !line.second.allFinite() || !line.force.allFinite())
    throw reader.error("a number of the contact is not finite; the run is void, look at its log");
  return line;
}

GrainContact contact_of(Line line, const Packing& packing, const Container& container) {
  if (line.first_id <= packing.fixed_count) {
    std::swap(line.first, line.second);
    std::swap(line.first_id, line.second_id);
    line.force = -line.force;
  }
  if (container.periodic) {
    const double period = container.upper.y() - container.lower.y();
    line.first.y() -= period * std::floor(line.first.y() / period);
    line.second.y() -= period * std::round((line.second.y() - line.first.y()) / period);
  }
  if (line.second_id <= packing.fixed_count) {
    const double radius = packing.radii[line.first_id - 1], other_radius = packing.radii[line.second_id - 1];
    line.second = line.first + (line.second - line.first) * radius / (radius + other_radius);
  }
  return {.centre = line.first, .other = line.second, .force = line.force};
}

std::vector<GrainContact> read_moment(DumpReader& reader, std::int64_t step, const Packing& packing,
                                      const Container& container) {
  if (reader.at_end()) throw reader.error("the file ends too soon: the run did not finish; run it again");
  reader.expect("ITEM: TIMESTEP");
  if (const auto found = reader.number_line<std::int64_t>(); found != step)
    throw reader.error(
        fmt::format("contacts of step {} where step {} belongs; the file is damaged", found, step));
  reader.expect("ITEM: NUMBER OF ENTRIES");
  const auto count = reader.number_line<std::int64_t>();
  reader.expect("ITEM: BOX BOUNDS");
  for (int axis = 0; axis < 3; ++axis) reader.line();
  reader.expect("ITEM: ENTRIES");
  std::vector<GrainContact> contacts;
  for (std::int64_t i = 0; i < count; ++i) {
    const Line line = read_line(reader);
    for (const auto id : {line.first_id, line.second_id}) {
      if (id < 1 || id > packing.count())
        throw reader.error(
            fmt::format("grain {} is none of the {} there are; the file is damaged", id, packing.count()));
    }
    contacts.push_back(contact_of(line, packing, container));
  }
  return contacts;
}

}  // namespace

ContactMoments read_contacts(const Case& a_case, const Packing& packing,
                             const std::filesystem::path& folder) {
  DumpReader reader(folder / contacts_file);
  const Container container = container_of(a_case);
  ContactMoments moments;
  moments.release = read_moment(reader, 0, packing, container);
  moments.end = read_moment(reader, step_schedule(a_case).run(), packing, container);
  return moments;
}

}  // namespace talus::dem
