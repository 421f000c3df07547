// Reading HDF5 files that anybody may have made: HDF5 itself writes as many values as an attribute claims to wherever it is told to, and
// callers ask for as much memory as a dataset claims to fill. All of these throw H5::Exception; not for other code than readers.
#pragma once

#include <H5Cpp.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>

namespace talus::analysis {

/// The attribute, which holds one value.
inline H5::Attribute open_single(const H5::H5Object& object, const char* name) {
  H5::Attribute attribute = object.openAttribute(name);
  if (attribute.getSpace().getSimpleExtentNpoints() != 1)
    throw H5::AttributeIException(name, fmt::format("attribute {} is not one value", name));
  return attribute;
}

inline int read_integer(const H5::H5Object& object, const char* name) {
  int value = 0;
  open_single(object, name).read(H5::PredType::NATIVE_INT, &value);
  return value;
}

inline double read_number(const H5::H5Object& object, const char* name) {
  double value = 0.0;
  open_single(object, name).read(H5::PredType::NATIVE_DOUBLE, &value);
  return value;
}

/// Empty where there is no such text.
inline std::string read_text(const H5::H5Object& object, const char* name) {
  std::string text;
  if (!object.attrExists(name)) return text;
  const H5::Attribute attribute = open_single(object, name);
  if (attribute.getTypeClass() == H5T_STRING) attribute.read(attribute.getStrType(), text);
  return text;
}

/// Deflate packs at most 1032 bytes into one. A damaged count must not ask for more memory than a file of that size can fill.
inline void check_claim(const H5::DataSet& set, const char* name, hsize_t rows, std::size_t bytes_of_row) {
  constexpr double largest_compression = 1100.0;
  const double bytes = static_cast<double>(rows) * static_cast<double>(bytes_of_row);
  if (bytes > largest_compression * static_cast<double>(std::filesystem::file_size(set.getFileName())))
    throw H5::DataSetIException(name, fmt::format("claims {} rows, more than the file can hold", rows));
}

}  // namespace talus::analysis
