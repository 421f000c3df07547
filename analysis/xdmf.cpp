#include "analysis/xdmf.h"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>

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

/// NumberType and Precision (bytes), as XDMF tells them.
std::string number_attributes(Number number) {
  switch (number) {
    case Number::float64:
      return R"(NumberType="Float" Precision="8")";
    case Number::float32:
      return R"(NumberType="Float" Precision="4")";
    case Number::uint32:
      return R"(NumberType="UInt" Precision="4")";
    case Number::uint8:
      return R"(NumberType="UChar" Precision="1")";
  }
  throw std::invalid_argument("unknown kind of number");
}

// Readers take the file name up to the first colon and look for it beside the XDMF.
std::string data_item(const SeriesItem& item, std::size_t count, std::string_view file,
                      std::string_view frame) {
  const std::string dimensions =
      item.components == 1 ? fmt::format("{}", count) : fmt::format("{} {}", count, item.components);
  return fmt::format(R"(<DataItem Format="HDF" {} Dimensions="{}">{}:/{}/{}</DataItem>)",
                     number_attributes(item.number), dimensions, file, frame, item.dataset);
}

}  // namespace

std::string frame_name(std::size_t index) { return fmt::format("frame_{:06}", index); }

std::string xdmf_document(std::string_view name, std::string_view file_name,
                          std::span<const SeriesItem> items, std::span<const FrameEntry> frames) {
  const std::string file = escaped(file_name);
  std::string out = fmt::format(R"(<?xml version="1.0"?>
<Xdmf Version="3.0">
  <Domain>
    <Grid Name="{}" GridType="Collection" CollectionType="Temporal">
)",
                                escaped(name));
  for (std::size_t index = 0; index < frames.size(); ++index) {
    const auto& [time, count] = frames[index];
    const std::string frame = frame_name(index);
    fmt::format_to(std::back_inserter(out), R"(      <Grid Name="{}" GridType="Uniform">
        <Time Value="{}"/>
        <Topology TopologyType="Polyvertex" NumberOfElements="{}" NodesPerElement="1"/>
)",
                   frame, time, count);
    for (const SeriesItem& item : items) {
      const std::string data = data_item(item, count, file, frame);
      if (std::string_view(item.attribute).empty()) {
        out += fmt::format("        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", data);
      } else {
        out += fmt::format(
            "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n",
            item.attribute, item.components == 1 ? "Scalar" : "Vector", data);
      }
    }
    out += "      </Grid>\n";
  }
  return out + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

}  // namespace talus::analysis
