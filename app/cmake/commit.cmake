# Writes OUTPUT, a header with the commit of SOURCE, when it has changed; "unknown" outside a checkout.
execute_process(COMMAND git -C "${SOURCE}" describe --always --dirty --abbrev=10 --exclude *
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT "#pragma once\n#define STILLPOINT_COMMIT \"${commit}\"\n")
