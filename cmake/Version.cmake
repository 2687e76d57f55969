# Run at build time: writes OUTPUT with the release and the commit of SOURCE (only when it changed).
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
set(VALSALVA_VERSION ${RELEASE})
if(NOT failed AND commit)
  set(VALSALVA_VERSION "${RELEASE}+${commit}")
endif()
configure_file(${SOURCE}/common/core/version.hpp.in ${OUTPUT} @ONLY)
