#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "report/kinds/kinds.hpp"
#include "report/page/page.hpp"

namespace test_page {

using carom::report::Chart;
using carom::report::Json;
using carom::report::kNone;
using carom::report::Page;

namespace {

/// The text between two marks; fails if they are not there.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
    const std::size_t from = text.find(begin);
    REQUIRE(from != std::string::npos);
    const std::size_t to = text.find(end, from + begin.size());
    REQUIRE(to != std::string::npos);
    return text.substr(from + begin.size(), to - from - begin.size());
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

Chart chart_with_everything() {
    return {.id = "price",
            .title = "Error against time",
            .x_label = "time (s)",
            .y_label = "error (m)",
            .log_x = true,
            .log_y = true,
            .series = {{.name = "soft </script><script>bad()</script>",
                        .points = {{.x = 0.1, .y = 1e-3, .low = 5e-4, .high = 2e-3, .label = "4 substeps"},
                                   {.x = 1.0 / 3, .y = std::nan(""), .label = "<!-- 8"}}},
                       {.name = "event", .points = {{.x = 2, .y = 1e-9}}, .line = false}},
            .slopes = {{.slope = -2, .name = "error ~ time^-2"}}};
}

}  // namespace

TEST_SUITE("report/page") {
    TEST_CASE("a chart's data come back from the page bit for bit, gaps as null") {
        Page page("Prices");
        page.chart(chart_with_everything());
        const Json data = Json::parse(
            between(page.html(), "<script type=\"application/json\" id=\"data-price\">", "</script>"));
        CHECK(data["x_label"] == "time (s)");
        CHECK(data["log_x"] == true);
        CHECK(data["series"][0]["name"] == "soft </script><script>bad()</script>");
        CHECK(data["series"][0]["x"][1].get<double>() == 1.0 / 3);
        CHECK(data["series"][0]["y"][1].is_null());
        CHECK(data["series"][0]["low"][0].get<double>() == 5e-4);
        CHECK(data["series"][0]["label"][1] == "<!-- 8");
        CHECK(data["series"][1].contains("low") == false);
        CHECK(data["series"][1]["line"] == false);
        CHECK(data["slopes"][0]["slope"].get<double>() == -2);
    }

    TEST_CASE("texts are shown as they are and never become markup") {
        const std::string bad = "<img src=x onerror=alert(1)>&\"'\xff";
        Page plain(""), page(bad);
        page.heading(bad);
        page.paragraph(bad);
        page.warning(bad);
        page.chart({.id = "c", .title = bad, .x_label = bad, .y_label = bad, .series = {{.name = bad}}});
        page.table({.caption = bad, .headers = {bad}, .rows = {{bad}}, .sortable = true});
        const std::string html = page.html();
        CHECK(html.find("<img") == std::string::npos);
        CHECK(html.find('\xff') == std::string::npos);
        CHECK(count(html, "&lt;img src=x onerror=alert(1)&gt;&amp;&quot;&#39;\xef\xbf\xbd") == 10);
        CHECK(count(html, "</script>") == count(plain.html(), "</script>") + 1);  // the chart's own data
    }

    TEST_CASE("a page fetches nothing: it names no other file and forbids loading one") {
        Page page("Prices");
        page.chart(chart_with_everything());
        const std::string html = page.html();
        for (const char* part : {" src=", " href=", "url(", "@import"}) {
            CAPTURE(part);
            CHECK(html.find(part) == std::string::npos);
        }
        CHECK(html.find("default-src 'none'") != std::string::npos);
        CHECK(html.find("Chart.js v3") != std::string::npos);
    }

    TEST_CASE("warnings come first, then parts in their order, neighbouring charts in one group") {
        Page page("Prices");
        page.heading("first");
        page.chart({.id = "a", .title = "A"});
        page.chart({.id = "b", .title = "B"});
        page.paragraph("between");
        page.chart({.id = "c", .title = "C"});
        page.warning("mind the gap");
        const std::string html = page.html();
        std::size_t at = 0;
        for (const char* part : {"mind the gap", "<h2>first", "<div class=\"charts\">", "chart-a", "chart-b",
                                 "</div>\n<p>between", "<div class=\"charts\">", "chart-c", "</main>"}) {
            CAPTURE(part);
            at = html.find(part, at);
            REQUIRE(at != std::string::npos);
        }
    }
}

TEST_SUITE("report/page") {
    TEST_CASE(
        "a page appended to another keeps its parts, and its charts stay apart from those with the same id") {
        Page first("First"), second("Second"), both("Results");
        for (Page* page : {&first, &second}) {
            page->chart({.id = "a", .title = page->title()});
            page->paragraph("of " + page->title());
        }
        second.warning("mind");
        both.append(first, "x-");
        both.append(second, "y-");
        const std::string html = both.html();
        CHECK(html.find("id=\"chart-x-a\"") < html.find("of First"));
        CHECK(html.find("<h2>Second</h2>") < html.find("id=\"chart-y-a\""));
        CHECK(html.find("id=\"data-y-a\"") != std::string::npos);
        CHECK(html.find("Second: mind") < html.find("<h2>First</h2>"));
    }
}

TEST_SUITE("report/kinds") {
    std::string refusal(const std::string& content) {
        const std::filesystem::path file = std::filesystem::temp_directory_path() / "carom-test-result.json";
        std::ofstream(file) << content;
        std::string message = "nothing was refused";
        try {
            carom::report::page_of({file});
        } catch (const carom::report::ResultError& error) {
            message = error.what();
        }
        std::filesystem::remove(file);
        return message;
    }

    TEST_CASE("what cannot be drawn is refused, naming the file, its kind and those that can") {
        CHECK(refusal("{\"kind\": \"soup\"}")
                  .find("carom-test-result.json: has the kind \"soup\", which cannot be drawn; expected one "
                        "of run") != std::string::npos);
        CHECK(refusal("{}").find("has no \"kind\"") != std::string::npos);
        CHECK(refusal("[1]").find("has no \"kind\"") != std::string::npos);
        CHECK(refusal("{\"kind\": ").find("is no JSON") != std::string::npos);
        CHECK(refusal("{\"kind\": \"run\"}").find("is not as its kind should be") != std::string::npos);
    }

    TEST_CASE("a run whose numbers are not finite is drawn all the same") {
        const Json none = nullptr,
                   energy{{"kinetic", none}, {"rotational", none}, {"potential", none}, {"total", none}};
        const Json run{
            {"kind", "run"},
            {"scene", "lost"},
            {"bodies", 1},
            {"steps", 1},
            {"dt", 1},
            {"time", none},
            {"solver", "impulse"},
            {"substeps", 1},
            {"iterations", 1},
            {"precision", "float"},
            {"isa", "scalar"},
            {"threads", 1},
            {"stages", Json::array()},
            {"version", "0"},
            {"state_hash", "0"},
            {"wall", {{"total_s", none}, {"ms_per_step", none}, {"ns_per_body_step", none}}},
            {"energy", {{"initial", energy}, {"final", energy}}},
            {"energy_by_cause", {{"gravity", none}, {"unexplained", none}}},
            {"momentum", {{"initial", {none, none}}, {"final", {none, none}}}},
            {"angular_momentum", {{"initial", none}, {"final", none}}},
            {"contacts", {{"touching", 0}, {"overlap_mean", none}, {"overlap_max", none}}},
            {"contacts_over_time",
             {{"time", {none}}, {"touching", {0}}, {"overlap_mean", {none}}, {"overlap_max", {none}}}},
            {"counters", {{"impacts", 0}, {"wall_impacts", 0}, {"unresolved_impacts", 0}}},
            {"files", Json::array()},
            {"messages", {"1 of 1 bodies were disabled"}}};
        CHECK(refusal(run.dump()) == "nothing was refused");
    }

    TEST_CASE("a folder that no run finished in is refused") {
        CHECK_THROWS_WITH_AS(carom::report::page_of({"/nonexistent/run.json"}),
                             "/nonexistent/run.json: cannot be read", carom::report::ResultError);
    }
}

}  // namespace test_page
