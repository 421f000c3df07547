#include "analysis/xdmf.h"

#include <fmt/format.h>

#include <iterator>

namespace talus::analysis {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// Readers take the file name up to the first colon and look for it beside the XDMF.
std::string data_item(std::string_view dimensions, std::string_view file, std::string_view path) {
  return fmt::format(
      R"(<DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{}">{}:{}</DataItem>)",
      dimensions, file, path);
}

}  // namespace

std::string frame_name(std::size_t index) { return fmt::format("frame_{:06}", index); }

std::string xdmf_document(std::string_view snapshot_file_name, std::span<const FrameEntry> frames) {
  const std::string file = escaped(snapshot_file_name);
  std::string out = R"(<?xml version="1.0"?>
<Xdmf Version="3.0">
  <Domain>
    <Grid Name="snapshots" GridType="Collection" CollectionType="Temporal">
)";
  for (std::size_t index = 0; index < frames.size(); ++index) {
    const auto& [time, count] = frames[index];
    const std::string name = frame_name(index);
    const std::string scalar = fmt::format("{}", count);
    const std::string vector = fmt::format("{} 3", count);
    fmt::format_to(std::back_inserter(out), R"(      <Grid Name="{}" GridType="Uniform">
        <Time Value="{}"/>
        <Topology TopologyType="Polyvertex" NumberOfElements="{}" NodesPerElement="1"/>
        <Geometry GeometryType="XYZ">{}</Geometry>
        <Attribute Name="velocity" AttributeType="Vector" Center="Node">{}</Attribute>
        <Attribute Name="volume" AttributeType="Scalar" Center="Node">{}</Attribute>
      </Grid>
)",
                   name, time, count, data_item(vector, file, "/" + name + "/positions"),
                   data_item(vector, file, "/" + name + "/velocities"),
                   data_item(scalar, file, "/" + name + "/volumes"));
  }
  return out + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

}  // namespace talus::analysis
