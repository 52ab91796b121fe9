// OpenCV chooses among SSE2, AVX2 and AVX-512 code by the CPU it finds, and they round differently. What is
// measured here is to be the same on every PC, so the program starts itself anew with all that lies beyond
// OpenCV's baseline turned off; OpenCV reads that from the environment before main begins.
// STILLPOINT_ACCURACY_CPU=1 in the environment measures with what the CPU has.
//
// The exit status is 77 when tests were skipped and none failed, and 1 when the filter fits no test.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

int main(int count, char** arguments) {
  constexpr int kSkipped = 77;
  constexpr const char* kChosen = "STILLPOINT_ACCURACY_CPU";
  if (std::getenv(kChosen) == nullptr) {
    setenv(kChosen, "baseline", 1);
    setenv("OPENCV_CPU_DISABLE", "AVX512-SKX,AVX2,FMA3,AVX,FP16,SSE4.2,SSE4.1,POPCNT,SSSE3,SSE3", 1);
    execv("/proc/self/exe", arguments);
    std::perror("accuracy_tests cannot start itself anew");
    return 1;
  }
  testing::InitGoogleTest(&count, arguments);
  const int status = RUN_ALL_TESTS();
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  if (all.test_to_run_count() == 0) {
    std::fputs("accuracy_tests: the filter fits no test\n", stderr);
    return 1;
  }
  return status == 0 && all.skipped_test_count() > 0 ? kSkipped : status;
}
