// Lines of progress.
#include <gtest/gtest.h>

#include "floe/files/log.h"

namespace floe {
namespace {

/// What `work` prints on standard error, which is no terminal.
std::string printed(auto&& work) {
  testing::internal::CaptureStderr();
  work();
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, LongWorkIsAnnouncedAtOnce) {
  EXPECT_EQ(printed([] {
              Progress progress("load steps", 2);
              progress.announce(0, "step 1, factorising 1.2e+06 unknowns", 40);
            }),
            "load steps: 0 %  step 1, factorising 1.2e+06 unknowns, about 40 s\n");
}

TEST(Progress, ShortWorkIsNotAnnounced) {
  const std::string text = printed([] {
    Progress progress("load steps", 2);
    progress.announce(0, "factorising", 0.1);
  });
  EXPECT_EQ(text.find("about"), std::string::npos) << text;
}

/// The second time what is expected is what the first took, whatever it was expected to take.
TEST(Progress, WorkIsExpectedToTakeAsLongAsBefore) {
  const std::string text = printed([] {
    Progress progress("load steps", 2);
    progress.announce(0, "first", 1000);
    progress.update(0);
    progress.announce(0, "second", 1000);
  });
  EXPECT_NE(text.find("first, about 1e+03 s\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("second, about 1e+03 s"), std::string::npos) << text;
}

}  // namespace
}  // namespace floe
