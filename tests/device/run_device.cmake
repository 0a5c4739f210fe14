# cmake -DPROGRAM=... -DDEVICE_PRESENT=... -DEXPECTED=ON|OFF -P run_device.cmake
#
# Runs PROGRAM if there is a GPU, which there has to be where one was found when the build was configured. It passes when
# it exits with 0 and its last line counts at least one check and no failure, as ours or as Catch2's do: a program that
# ends early does not pass by silence. One that tells the `bits:` of what it has computed has to tell the same ones in
# another process.
execute_process(COMMAND "${DEVICE_PRESENT}" RESULT_VARIABLE absent)
if(absent AND EXPECTED)
  message(FATAL_ERROR "nvidia-smi names a GPU, but no kernel runs on it")
elseif(absent)
  message("skipped: no GPU")
  return()
endif()
execute_process(COMMAND "${PROGRAM}" RESULT_VARIABLE failed OUTPUT_VARIABLE out ECHO_OUTPUT_VARIABLE)
string(STRIP "${out}" out)
if(failed OR NOT out MATCHES "(^|\n)([1-9][0-9]* passed, 0 failed|All tests passed [^\n]*)$")
  message(FATAL_ERROR "${PROGRAM}: exit status ${failed}, no closing line `N passed, 0 failed`")
endif()
string(REGEX MATCH "(^|\n)bits: [0-9a-f]+" bits "${out}")
if(bits)
  execute_process(COMMAND "${PROGRAM}" OUTPUT_VARIABLE again)
  string(REGEX MATCH "(^|\n)bits: [0-9a-f]+" other "${again}")
  if(NOT bits STREQUAL other)
    message(FATAL_ERROR "${PROGRAM}: other bits in another process:${bits}${other}")
  endif()
endif()
