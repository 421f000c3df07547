#include <H5Cpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "continuum/files/atomic_file.h"
#include "continuum/qp/problem_file.h"
#include "continuum/qp/problem_format.h"

namespace talus {

using namespace problem_format;

namespace {

constexpr unsigned deflate_level = 1;     // light: a run waits while it writes
constexpr hsize_t largest_chunk = 65536;  // values

/// Keeps the bytes of a file that HDF5 holds in memory, which HDF5 would free when it closes the file. (An image taken
/// before, by H5Fget_file_image, has a wrong checksum in HDF5 1.10.)
class ClosedFile {
 public:
  H5FD_file_image_callbacks_t callbacks() {
    const auto same = [](void* self) { return self; };
    const auto leave = [](void*) { return herr_t{0}; };
    return {allocate, copy, reallocate, release, same, leave, this};
  }
  /// Null while the file is open.
  const char* bytes() const { return static_cast<const char*>(bytes_.get()); }

 private:
  static void* allocate(std::size_t size, H5FD_file_image_op_t, void*) { return std::malloc(size); }
  static void* copy(void* to, const void* from, std::size_t size, H5FD_file_image_op_t, void*) {
    return std::memcpy(to, from, size);
  }
  static void* reallocate(void* block, std::size_t size, H5FD_file_image_op_t, void*) {
    return std::realloc(block, size);
  }
  static herr_t release(void* block, H5FD_file_image_op_t operation, void* self) {
    if (operation == H5FD_FILE_IMAGE_OP_FILE_CLOSE)
      static_cast<ClosedFile*>(self)->bytes_.reset(block);
    else
      std::free(block);
    return 0;
  }

  struct Free {
    void operator()(void* block) const { std::free(block); }
  };
  std::unique_ptr<void, Free> bytes_;
};

/// An HDF5 file that is built in memory, so that the disk is left to write_file_atomically: HDF5 1.10 does not survive a
/// full one.
class Image {
 public:
  void text(const char* name, std::string_view text) {
    H5::StrType type(H5::PredType::C_S1, std::max<std::size_t>(1, text.size()));
    type.setStrpad(H5T_STR_NULLPAD);
    type.setCset(H5T_CSET_UTF8);
    root_.createAttribute(name, type, H5::DataSpace()).write(type, std::string(text));
  }
  template <class Number>
  void number(const char* name, Number value) {
    number(root_, name, value);
  }

  template <class Number>
  void list(const std::string& name, const Number* values, std::size_t count) {
    const hsize_t size = count;
    H5::DSetCreatPropList layout;
    if (size > 0) {
      const hsize_t chunk = std::min(size, largest_chunk);
      layout.setChunk(1, &chunk);
      layout.setShuffle();
      layout.setDeflate(deflate_level);
      layout.setFletcher32();
    }
    H5::DataSet set = file_.createDataSet(name, type_of<Number>(), H5::DataSpace(1, &size), layout);
    if (size > 0) set.write(values, type_of<Number>());
  }
  template <class List>
  void list(const std::string& name, const List& values) {
    list(name, values.data(), static_cast<std::size_t>(values.size()));
  }

  void matrix(const SparseMatrix& matrix) {
    H5::Group group = file_.createGroup("matrix");
    number(group, "rows", std::int64_t{matrix.rows()});
    number(group, "columns", std::int64_t{matrix.cols()});
    const Eigen::Map<const Eigen::ArrayXi> offsets(matrix.outerIndexPtr(), matrix.cols() + 1),
        rows(matrix.innerIndexPtr(), matrix.nonZeros());
    list("matrix/offsets", Integers(offsets.cast<std::int64_t>()));
    list("matrix/rows", Integers(rows.cast<std::int64_t>()));
    list("matrix/values", matrix.valuePtr(), static_cast<std::size_t>(matrix.nonZeros()));
  }

  void group(const char* name) { file_.createGroup(name); }

  /// The whole file; nothing can be added afterwards.
  std::string bytes() {
    file_.flush(H5F_SCOPE_GLOBAL);
    const auto size = static_cast<std::size_t>(file_.getFileSize());
    root_.close();
    file_.close();
    return {closed_.bytes(), size};
  }

 private:
  static H5::FileAccPropList in_memory(ClosedFile& closed) {
    constexpr std::size_t growth = 1;  // byte: the file ends where its content does
    H5::FileAccPropList access;
    access.setCore(growth, false);
    access.setLibverBounds(H5F_LIBVER_V110, H5F_LIBVER_V110);  // the first that checksums all metadata
    auto callbacks = closed.callbacks();
    if (H5Pset_file_image_callbacks(access.getId(), &callbacks) < 0)
      throw H5::PropListIException("H5Pset_file_image_callbacks", "failed");
    return access;
  }
  template <class Number>
  static void number(H5::Group& of, const char* name, Number value) {
    of.createAttribute(name, type_of<Number>(), H5::DataSpace()).write(type_of<Number>(), &value);
  }

  ClosedFile closed_;
  H5::H5File file_{"problem.h5", H5F_ACC_TRUNC, H5::FileCreatPropList::DEFAULT, in_memory(closed_)};
  H5::Group root_ = file_.openGroup("/");
};

void write_settings(Image& image, double tolerance, int max_iterations) {
  image.number("tolerance", tolerance);
  image.number("max_iterations", std::int64_t{max_iterations});
}

void write_content(Image& image, const BoundQp& qp) {
  image.text("kind", "bound");
  image.text("name", qp.name);
  image.number("norm", qp.norm);
  write_settings(image, qp.settings.tolerance, qp.settings.max_iterations);
  image.matrix(qp.matrix);
  image.list("linear", qp.linear);
  image.list("lower", qp.lower);
  image.list("upper", qp.upper);
  image.list("start", qp.start);
}

void write_content(Image& image, const ConeQp& qp) {
  image.text("kind", "cone");
  image.text("name", qp.name);
  image.number("lipschitz", qp.lipschitz);
  write_settings(image, qp.settings.gap_tolerance, qp.settings.max_iterations);
  image.matrix(qp.k);
  image.list("mass", qp.mass);
  image.list("free_velocity", qp.free_velocity);
  image.list("start", qp.start);
  image.group("balls");
  image.list("balls/size", std::vector<std::int64_t>(qp.balls.size.begin(), qp.balls.size.end()));
  image.list("balls/count", std::vector<std::int64_t>(qp.balls.count.begin(), qp.balls.count.end()));
  image.list("balls/radius", qp.balls.radius);
  image.list("balls/curvature", qp.balls.curvature);
}

}  // namespace

void write_problem(const Path& file, const Problem& problem, std::string_view made_by) {
  if (const auto defect = find_defect(problem))
    throw error_about(file, fmt::format("not written, the problem is defective: {}", *defect));
  const std::string bytes = translating_errors(file, "cannot be written", [&] {
    Image image;
    image.text("format", problem_format::name);
    image.number("version", version);
    image.text("made_by", made_by);
    std::visit([&](const auto& qp) { write_content(image, qp); }, problem);
    return image.bytes();
  });
  write_file_atomically(file, bytes);
}

Path problem_path(const Path& output, int step, int number, std::string_view name) {
  return output / "qp" / fmt::format("step_{:06}", step) / fmt::format("{:02}_{}.h5", number, name);
}

ProblemRecorder record_step(const Path& output, int step, std::string_view made_by) {
  // Copies of the recorder count on together.
  const auto number = std::make_shared<int>(0);
  return [output, step, made_by = std::string(made_by), number](const Problem& problem) {
    const std::string name = std::visit([](const auto& qp) { return qp.name; }, problem);
    const Path file = problem_path(output, step, *number, name);
    if ((*number)++ == 0) make_writable_folder(file.parent_path());
    write_problem(file, problem, made_by);
  };
}

}  // namespace talus
