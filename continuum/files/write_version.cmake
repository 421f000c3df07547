# Run at every build: writes OUTPUT with the source revision, and touches it only when that changed.
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
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [=[
#pragma once
#define TALUS_GIT_HASH "@revision@"
#define TALUS_GIT_DIRTY @dirty@
]=] @ONLY)
