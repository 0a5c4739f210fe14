# cmake -DPROGRAM=... -DDEVICE_PRESENT=... -P run_device.cmake
#
# Runs PROGRAM if there is a GPU. It passes when it exits with 0 and its last line counts at least one
# check and no failure: a program that ends early does not pass by silence.
execute_process(COMMAND "${DEVICE_PRESENT}" RESULT_VARIABLE absent)
if(absent)
  message("skipped: no GPU")
  return()
endif()
execute_process(COMMAND "${PROGRAM}" RESULT_VARIABLE failed OUTPUT_VARIABLE out ECHO_OUTPUT_VARIABLE)
string(STRIP "${out}" out)
if(failed OR NOT out MATCHES "(^|\n)[1-9][0-9]* passed, 0 failed$")
  message(FATAL_ERROR "${PROGRAM}: exit status ${failed}, no closing line `N passed, 0 failed`")
endif()
