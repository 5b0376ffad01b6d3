#include "lancet/experiments/common/progress.hpp"

#include <sstream>

#include <gtest/gtest.h>

namespace lancet::experiments {
namespace {

TEST(Progress, PlainLinesWhereThereIsNoTerminal) {
    std::ostringstream stream;
    {
        Progress progress(stream, 0);
        progress.show(1, 2, "serial");
        progress.show(1, 2, "serial");  // nothing new
        progress.show(2, 2, "tbb");
    }
    EXPECT_EQ(stream.str(), "[1/2] serial\n[2/2] tbb\n");
}

TEST(Progress, OneLineOnATerminal) {
    std::ostringstream stream;
    {
        Progress progress(stream, 80);
        progress.show("first");
        progress.show("second");
    }
    EXPECT_EQ(stream.str(), "\r\033[Kfirst\r\033[Ksecond\r\033[K");
}

TEST(Progress, ShortenedToTheWidthInCodePoints) {
    std::ostringstream stream;
    Progress progress(stream, 5);
    progress.show("µµµµµµ");
    EXPECT_EQ(stream.str(), "\r\033[Kµµµµ");
}

TEST(Progress, NothingShownIsNothingToClear) {
    std::ostringstream stream;
    { const Progress progress(stream, 80); }
    EXPECT_EQ(stream.str(), "");
}

}  // namespace
}  // namespace lancet::experiments
