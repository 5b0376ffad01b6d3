# Run at every build: writes the header OUTPUT with the commit of SOURCE_DIR, and touches it only when that changed.
# GIT is the git executable, which may be missing.

set(commit "unknown")
set(dirty false)
if(GIT)
  execute_process(COMMAND "${GIT}" -C "${SOURCE_DIR}" rev-parse HEAD
                  OUTPUT_VARIABLE head RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(commit "${head}")
    # Optional locks would make this build disturb git commands that run beside it.
    execute_process(COMMAND "${GIT}" --no-optional-locks -C "${SOURCE_DIR}" status --porcelain
                    OUTPUT_VARIABLE changes RESULT_VARIABLE failed ERROR_QUIET)
    if(failed OR NOT changes STREQUAL "")
      set(dirty true)
    endif()
  endif()
endif()

set(header "#pragma once

#include <string_view>

namespace lancet::runtime::build_facts {

inline constexpr std::string_view commit = \"${commit}\";
inline constexpr bool dirty = ${dirty};

}  // namespace lancet::runtime::build_facts
")
set(before "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" before)
endif()
if(NOT before STREQUAL header)
  file(WRITE "${OUTPUT}.new" "${header}")
  file(RENAME "${OUTPUT}.new" "${OUTPUT}")
endif()
