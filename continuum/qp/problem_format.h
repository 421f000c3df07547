// What the writer and the reader of problem files share; not for other code.
#pragma once

#include <H5Cpp.h>
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <new>
#include <string_view>

#include "continuum/files/input_error.h"
#include "continuum/qp/problem_file.h"

namespace talus::problem_format {

using Path = std::filesystem::path;
using SparseMatrix = Eigen::SparseMatrix<double>;
using Integers = Eigen::Array<std::int64_t, Eigen::Dynamic, 1>;

inline constexpr const char* name = "talus-qp";
inline constexpr std::int64_t version = 1;

/// How a number is stored.
template <class Number>
const H5::PredType& type_of();
template <>
inline const H5::PredType& type_of<double>() {
  return H5::PredType::IEEE_F64LE;
}
template <>
inline const H5::PredType& type_of<std::int64_t>() {
  return H5::PredType::STD_I64LE;
}

inline InputError error_about(const Path& file, std::string_view what) {
  return InputError(fmt::format("{}: {}", file.string(), what));
}

/// Whatever HDF5 says in `action` becomes one InputError that names the file.
template <class Action>
auto translating_errors(const Path& file, std::string_view doing, Action&& action) {
  H5::Exception::dontPrint();
  try {
    return action();
  } catch (const H5::Exception& exception) {
    throw error_about(file, fmt::format("{}: HDF5 says '{}' in {}", doing, exception.getDetailMsg(),
                                        exception.getFuncName()));
  } catch (const std::bad_alloc&) {
    throw error_about(file, fmt::format("{}: not enough memory", doing));
  }
}

}  // namespace talus::problem_format
