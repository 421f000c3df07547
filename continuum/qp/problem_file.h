// Quadratic programs on disk, one problem a file, to be solved again offline (by tests, benchmarks, PETSc).
//
// The file is HDF5. All numbers are 64-bit, little-endian: float64 (infinite bounds as IEEE infinities) and int64. Every
// dataset is a list (one dimension), checksummed; metadata is checksummed by HDF5. Text is UTF-8 of fixed length: what has
// a variable length HDF5 keeps without a checksum, and crashes on when it is damaged. What is written is read back to the
// last bit.
//
//   /            attributes: format = "talus-qp", version = 1, kind = "bound" or "cone", name, made_by (text);
//                max_iterations (int64), tolerance (float64: of the residual, or of the duality gap in J)
//   kind bound   attribute norm; groups and lists: matrix (A), linear, lower, upper, start
//   kind cone    attribute lipschitz; matrix (K), mass, free_velocity, start,
//                balls/size (2), balls/count (2), balls/radius, balls/curvature
//   /matrix      attributes rows, columns; compressed sparse columns: offsets (columns + 1), rows (ascending within a
//                column), values. Entries of column j are those from offsets[j] up to offsets[j + 1].
//
// For their meaning see problem.h.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "continuum/qp/problem.h"

namespace talus {

/// Writes the whole file or none. `made_by` is free text that says what made it. Throws InputError when the problem has a
/// defect, or the file cannot be written.
void write_problem(const std::filesystem::path& file, const Problem& problem, std::string_view made_by);

/// Throws InputError naming the file and what is wrong: missing, foreign, of another version, damaged, defective.
Problem read_problem(const std::filesystem::path& file);

/// OUTPUT/qp/step_000012/03_pressure.h5: the `number`th problem of a step, both counted from 0.
std::filesystem::path problem_path(const std::filesystem::path& output, int step, int number,
                                   std::string_view name);

/// Writes the problems of one step to their paths, in the order in which they are solved. Makes the folder with the first.
/// Throws InputError as write_problem does.
ProblemRecorder record_step(const std::filesystem::path& output, int step, std::string_view made_by);

}  // namespace talus
