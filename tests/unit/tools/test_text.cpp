// The small texts of the command line program: CSV fields, numbers, progress, names of folders.
#include "results/text_file.hpp"
#include "run/run_scene.hpp"
#include "terminal/format.hpp"
#include "terminal/option_values.hpp"
#include "terminal/progress_bar.hpp"

#include <doctest/doctest.h>

#include <charconv>
#include <cmath>
#include <limits>

namespace test_text {

using namespace carom::tool;

TEST_SUITE("tools/text") {
    TEST_CASE("numbers in CSV files read back as the same double") {
        using Limits = std::numeric_limits<double>;
        for (const double value : {0.1, -0.0, 1.0 / 3, 1e300, 5e-324, Limits::max(), Limits::min(), 0.1 + 0.2,
                                   static_cast<double>(0.1f), -123456789.125}) {
            std::string text;
            append_number(text, value);
            double again = 1;
            const auto result = std::from_chars(text.data(), text.data() + text.size(), again);
            CHECK(result.ptr == text.data() + text.size());
            CHECK(std::signbit(again) == std::signbit(value));
            CHECK(again == value);
        }
    }

    TEST_CASE("CSV fields are quoted only if they must be") {
        const auto field = [](std::string_view text) {
            std::string line;
            append_field(line, text);
            return line;
        };
        CHECK(field("plain name") == "plain name");
        CHECK(field("") == "");
        CHECK(field("a,b") == "\"a,b\"");
        CHECK(field("say \"x\"") == "\"say \"\"x\"\"\"");
        CHECK(field("two\nlines") == "\"two\nlines\"");
    }

    TEST_CASE("the progress line shows part, rate and time left, and fits a terminal") {
        CHECK(progress_line(250, 1000, 2.5) ==
              "[###...........]  25 %  step 250 of 1000  100 steps/s  0:08 left");
        CHECK(progress_line(0, 0, 0).find("100 %") != std::string::npos);
        CHECK(progress_line(0, 10, 0).find("0 %") != std::string::npos);
        CHECK(progress_line(1, 4000000000, 10).find("over 99 h") != std::string::npos);
        CHECK(progress_line(36, 7200, 18).find("59:42 left") != std::string::npos);
        CHECK(progress_line(36, 14400, 18).find("1:59:42 left") != std::string::npos);
        CHECK(progress_line(123456, 1000000000, 60).size() < 80);
    }

    TEST_CASE("a scene's name becomes the name of one folder, inside the output folder") {
        CHECK(folder_name("seed") == "seed");
        CHECK(folder_name("gas 10,000") == "gas 10_000");
        CHECK(folder_name("../../etc/passwd") == "_.._.._etc_passwd");
        CHECK(folder_name("..") == "_..");
        CHECK(folder_name("") == "_");
        CHECK(folder_name(std::string(1000, 'x')).size() <= 101);
        CHECK(folder_name(std::string("a\0b\n", 4)) == "a_b_");
    }

    TEST_CASE("values that round to zero are printed without a minus") {
        CHECK(format("%.2f", without_minus_zero(-0.004, 2)) == "0.00");
        CHECK(format("%.2f", without_minus_zero(-0.006, 2)) == "-0.01");
        CHECK(format("%.3f", without_minus_zero(-0.0, 3)) == "0.000");
    }

    TEST_CASE("long texts are formatted whole") {
        const std::string name(1000, 'n');
        CHECK(format("<%s>", name.c_str()) == joined("<", name, ">"));
    }

    TEST_CASE("lists are split at every comma") {
        CHECK(split_at_commas("+a,-b") == std::vector<std::string>{"+a", "-b"});
        CHECK(split_at_commas("") == std::vector<std::string>{""});
        CHECK(split_at_commas(",") == std::vector<std::string>{"", ""});
    }
}

}  // namespace test_text
