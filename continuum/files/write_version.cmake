# Run at every build: writes OUTPUT with the source revision and a name for the solver's sources, and touches it only when those changed.
execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse --short=12 HEAD OUTPUT_VARIABLE revision
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND git -C ${SOURCE_DIR} status --porcelain OUTPUT_VARIABLE changes ERROR_QUIET)
if(NOT revision)
  set(revision unknown)
endif()
set(dirty false)
if(changes)
  set(dirty true)
endif()
# What decides the solver's results: its code, and how snapshots are written. Documents, scenes, pictures, the other commands of talus
# and other programs do not.
file(GLOB_RECURSE sources ${SOURCE_DIR}/continuum/*.h ${SOURCE_DIR}/continuum/*.cpp ${SOURCE_DIR}/continuum/CMakeLists.txt
     ${SOURCE_DIR}/analysis/snapshot* ${SOURCE_DIR}/analysis/series_file*)
list(FILTER sources EXCLUDE REGEX "/continuum/(render/|program/(bench|check)\\.)|/analysis/snapshot_reader")
list(SORT sources)
set(all "")
foreach(source ${sources})
  file(SHA256 ${source} hash)
  file(RELATIVE_PATH name ${SOURCE_DIR} ${source})
  string(APPEND all "${name} ${hash}\n")
endforeach()
string(SHA256 solver_sources "${all}")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [=[
#pragma once
#define TALUS_GIT_HASH "@revision@"
#define TALUS_GIT_DIRTY @dirty@
#define TALUS_SOLVER_SOURCES "@solver_sources@"
]=] @ONLY)
