// A try in a child process, for libraries that crash or hang over damaged files.
#pragma once

#include <functional>

namespace talus::analysis {

/// Whether a copy of this process gets through `action`, be it by an exception, within so many seconds of processor time. What
/// it does to memory is gone afterwards. Throws std::system_error where no process can be made.
bool survives(const std::function<void()>& action, double seconds);

}  // namespace talus::analysis
