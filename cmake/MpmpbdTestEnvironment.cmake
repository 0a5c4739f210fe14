# The environment that tests and examples run in.
set(MPMPBD_TEST_ENVIRONMENT
  OMP_NUM_THREADS=2 OMP_WAIT_POLICY=passive  # tests run side by side: no thread may spin
  # The OpenMP run-time library of clang is not instrumented for tsan; its own locks look like races.
  TSAN_OPTIONS=ignore_noninstrumented_modules=1
  UBSAN_OPTIONS=print_stacktrace=1
  ASAN_OPTIONS=detect_stack_use_after_return=1)
