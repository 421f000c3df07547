#include "continuum/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "continuum/files/input_error.h"
#include "continuum/files/put_in_place.h"

namespace talus {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* what) {
  throw InputError(fmt::format("{}: {}: {}", file.string(), what, std::strerror(errno)));
}

InputError not_in_place(const std::filesystem::path& file, const std::error_code& why) {
  return InputError(fmt::format("{}: cannot put in place: {}", file.string(), why.message()));
}

}  // namespace

void write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  std::filesystem::path temporary = file;
  temporary += fmt::format(".partial-{}", ::getpid());
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) fail(file, "cannot write here");
  const auto give_up = [&](const char* what) {
    const int why = errno;
    ::close(descriptor);
    ::unlink(temporary.c_str());
    errno = why;
    fail(file, what);
  };
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0) give_up("cannot write");
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(descriptor) != 0) give_up("cannot flush to disk");
  if (::close(descriptor) != 0) fail(file, "cannot close");
  if (const std::error_code why = put_in_place(temporary, file)) {
    ::unlink(temporary.c_str());
    throw not_in_place(file, why);
  }
}

GrowingFile::GrowingFile(std::filesystem::path file, std::string_view content)
    : file_(std::move(file)), temporary_(file_) {
  temporary_ += ".partial";
  out_.open(temporary_, std::ios::binary | std::ios::trunc);
  append(content);
}

GrowingFile::GrowingFile(std::filesystem::path file, std::int64_t bytes)
    : file_(std::move(file)), temporary_(file_) {
  temporary_ += ".partial";
  std::error_code why;
  if (!std::filesystem::exists(temporary_) && std::filesystem::exists(file_))
    std::filesystem::rename(file_, temporary_, why);  // it was killed just after this file was whole
  const auto there = std::filesystem::file_size(temporary_, why);
  if (why || there < static_cast<std::uintmax_t>(bytes)) {
    throw InputError(fmt::format("{}: {} bytes of an unfinished run should be here{}", temporary_.string(),
                                 bytes, why ? "" : fmt::format(", and {} are", there)));
  }
  std::filesystem::resize_file(temporary_, static_cast<std::uintmax_t>(bytes), why);
  if (why) throw InputError(fmt::format("{}: cannot be cut: {}", temporary_.string(), why.message()));
  out_.open(temporary_, std::ios::binary | std::ios::app);
  append("");
}

void GrowingFile::append(std::string_view content) {
  out_ << content << std::flush;
  if (!out_) fail(file_, "cannot write");
}

std::int64_t GrowingFile::save() {
  append("");
  const int descriptor = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(file_, "cannot flush to disk");
  const bool flushed = ::fsync(descriptor) == 0;
  const int why = errno;
  const off_t size = ::lseek(descriptor, 0, SEEK_END);
  ::close(descriptor);
  errno = why;
  if (!flushed) fail(file_, "cannot flush to disk");
  return size;
}

void GrowingFile::finish() {
  out_.close();
  if (!out_) fail(file_, "cannot write");
  if (const std::error_code why = put_in_place(temporary_, file_)) throw not_in_place(file_, why);
}

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno)));
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

void make_writable_folder(const std::filesystem::path& folder) {
  std::error_code why;
  std::filesystem::create_directories(folder, why);
  if (why) throw InputError(fmt::format("{}: cannot make this folder: {}", folder.string(), why.message()));
  // A file without a name leaves nothing, wherever the process is killed. Not every file system has such.
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (descriptor >= 0) {
    ::close(descriptor);
    return;
  }
  if (errno != EOPNOTSUPP) fail(folder, "cannot write here");
  const auto probe = folder / ".writable";
  write_file_atomically(probe, "");
  std::filesystem::remove(probe);
}

}  // namespace talus
