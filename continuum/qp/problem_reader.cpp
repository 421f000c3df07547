#include <H5Cpp.h>
#include <fmt/format.h>

#include <array>
#include <limits>
#include <string>
#include <utility>

#include "continuum/qp/problem_file.h"
#include "continuum/qp/problem_format.h"

namespace talus {

using namespace problem_format;

namespace {

constexpr hsize_t most_expansion = 1100;  // deflate packs at most 1032 bytes into one

/// Reads named things of a file, each checked before it is believed.
class Reader {
 public:
  explicit Reader(const Path& path) : path_(path), file_(path.string(), H5F_ACC_RDONLY) {}

  std::string text(const char* name) const {
    const H5::Attribute attribute = open_attribute("/", name);
    if (attribute.getTypeClass() != H5T_STRING || attribute.getSpace().getSimpleExtentNpoints() != 1 ||
        attribute.getStrType().isVariableStr())
      throw error_about(path_, fmt::format("attribute {} is no text of fixed length", name));
    std::string value;
    attribute.read(attribute.getStrType(), value);
    return value;
  }

  template <class Number>
  Number number(const char* name, const char* of = "/") const {
    const H5::Attribute attribute = open_attribute(of, name);
    if (!(attribute.getDataType() == type_of<Number>()) || attribute.getSpace().getSimpleExtentNpoints() != 1)
      throw error_about(path_, fmt::format("attribute {} is not one 64-bit number of the right kind", name));
    Number value{};
    attribute.read(type_of<Number>(), &value);
    return value;
  }

  /// A number that fits an int.
  int integer(const char* name, const char* of = "/") const {
    return narrowed(number<std::int64_t>(name, of), name);
  }

  template <class Number>
  Eigen::Array<Number, Eigen::Dynamic, 1> list(const std::string& name) const {
    if (!exists(name)) throw error_about(path_, fmt::format("dataset {} is missing", name));
    const H5::DataSet set = file_.openDataSet(name);
    const H5::DataSpace space = set.getSpace();
    if (!space.isSimple() || space.getSimpleExtentNdims() != 1 || !(set.getDataType() == type_of<Number>()))
      throw error_about(path_,
                        fmt::format("dataset {} is not a list of 64-bit numbers of the right kind", name));
    hsize_t size = 0;
    space.getSimpleExtentDims(&size);
    const hsize_t stored = set.getStorageSize();
    if (stored > file_.getFileSize() || size > most_expansion * stored / sizeof(Number)) {
      throw error_about(
          path_, fmt::format("dataset {} claims {} values, but {} stored bytes cannot hold them", name, size,
                             stored));
    }
    Eigen::Array<Number, Eigen::Dynamic, 1> values(static_cast<Eigen::Index>(size));
    if (size > 0) set.read(values.data(), type_of<Number>());
    return values;
  }

  SparseMatrix matrix() const {
    if (!exists("matrix")) throw error_about(path_, "group matrix is missing");
    const int rows = integer("rows", "matrix"), columns = integer("columns", "matrix");
    const Integers offsets = list<std::int64_t>("matrix/offsets"),
                   entry_rows = list<std::int64_t>("matrix/rows");
    const Eigen::ArrayXd values = list<double>("matrix/values");
    const auto require = [&](bool holds, std::string_view otherwise) {
      if (!holds) throw error_about(path_, fmt::format("matrix: {}", otherwise));
    };
    require(rows >= 0 && columns >= 0, "its size is negative");
    require(offsets.size() == Eigen::Index{columns} + 1,
            fmt::format("{} offsets for {} columns", offsets.size(), columns));
    require(entry_rows.size() == values.size() && values.size() <= std::numeric_limits<int>::max(),
            fmt::format("{} rows for {} values", entry_rows.size(), values.size()));
    require(offsets[0] == 0 && offsets[columns] == values.size(), "the offsets do not span the values");
    for (int column = 0; column < columns; ++column) {
      require(offsets[column] <= offsets[column + 1] && offsets[column + 1] <= values.size(),
              "the offsets do not ascend");
      for (std::int64_t entry = offsets[column]; entry < offsets[column + 1]; ++entry) {
        require(entry_rows[entry] >= 0 && entry_rows[entry] < rows, "an entry lies outside");
        require(entry == offsets[column] || entry_rows[entry - 1] < entry_rows[entry],
                "the rows of a column do not ascend");
      }
    }
    const Eigen::ArrayXi outer = offsets.cast<int>(), inner = entry_rows.cast<int>();
    return Eigen::Map<const SparseMatrix>(rows, columns, values.size(), outer.data(), inner.data(),
                                          values.data());
  }

  std::array<int, 2> pair(const std::string& name) const {
    const Integers values = list<std::int64_t>(name);
    if (values.size() != 2)
      throw error_about(path_, fmt::format("dataset {} has {} values, not 2", name, values.size()));
    return {narrowed(values[0], name), narrowed(values[1], name)};
  }

 private:
  bool exists(const std::string& name) const {
    return H5Lexists(file_.getId(), name.c_str(), H5P_DEFAULT) > 0;
  }

  H5::Attribute open_attribute(const char* of, const char* name) const {
    const H5::Group group = file_.openGroup(of);
    if (!group.attrExists(name)) throw error_about(path_, fmt::format("attribute {} is missing", name));
    return group.openAttribute(name);
  }

  int narrowed(std::int64_t value, std::string_view name) const {
    if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max())
      throw error_about(path_, fmt::format("{} = {} is beyond what this program can hold", name, value));
    return static_cast<int>(value);
  }

  const Path& path_;
  H5::H5File file_;
};

BoundQp read_bound(const Reader& reader) {
  return {
      reader.text("name"),           reader.matrix(),
      reader.list<double>("linear"), reader.list<double>("lower"),
      reader.list<double>("upper"),  reader.list<double>("start"),
      reader.number<double>("norm"), {reader.number<double>("tolerance"), reader.integer("max_iterations")}};
}

ConeQp read_cone(const Reader& reader) {
  const auto count = reader.pair("balls/count");
  BallBlocks balls{reader.pair("balls/size"),
                   {count[0], count[1]},
                   reader.list<double>("balls/radius"),
                   reader.list<double>("balls/curvature")};
  return {reader.text("name"),
          reader.matrix(),
          reader.list<double>("mass"),
          reader.list<double>("free_velocity"),
          std::move(balls),
          reader.list<double>("start"),
          reader.number<double>("lipschitz"),
          {reader.number<double>("tolerance"), reader.integer("max_iterations")}};
}

Problem read_content(const Path& path, const Reader& reader) {
  const std::string kind = reader.text("kind");
  if (kind == "bound") return read_bound(reader);
  if (kind == "cone") return read_cone(reader);
  throw error_about(path, fmt::format("kind '{}' is neither 'bound' nor 'cone'", kind));
}

}  // namespace

Problem read_problem(const Path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) throw error_about(file, "no such file");
  Problem problem = translating_errors(file, "damaged, or not a file of a quadratic program", [&] {
    const Reader reader(file);
    if (reader.text("format") != problem_format::name)
      throw error_about(file, fmt::format("not a file of a quadratic program (format is not \"{}\")",
                                          problem_format::name));
    if (const auto found = reader.number<std::int64_t>("version"); found != version) {
      throw error_about(
          file, fmt::format("version {} of the format; this program reads version {}", found, version));
    }
    return read_content(file, reader);
  });
  if (const auto defect = find_defect(problem))
    throw error_about(file, fmt::format("defective: {}", *defect));
  return problem;
}

}  // namespace talus
