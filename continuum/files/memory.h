// How much memory this machine has.
#pragma once

#include <string>

namespace talus {

/// Bytes of the whole machine; without a limit where the system does not say.
double memory_of_machine();
/// Bytes that programs can still have without swapping (MemAvailable of /proc/meminfo); else that of the machine.
double memory_available();
/// Bytes in words: "3.2 GB".
std::string memory_text(double bytes);

}  // namespace talus
