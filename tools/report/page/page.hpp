#pragma once

#include <functional>
#include <iosfwd>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "report/page/markup.hpp"

namespace carom::report {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// One measured value. `low` and `high` are the ends of its error bar, if it has one.
struct Point {
    double x = 0;
    double y = 0;  ///< a value that is not finite is a gap
    double low = kNone;
    double high = kNone;
    std::string label{};  ///< shown on hover, and under the bar in a chart of bars
};

struct Series {
    std::string name{};
    std::vector<Point> points{};
    bool line = true;     ///< joined in their order, else marks alone
    bool area = false;    ///< filled down to zero, or to the series below in the same stack
    std::string stack{};  ///< series of one stack are added up
    int colour = -1;      ///< index into the page's palette; -1: the series' place in the chart
    bool in_legend = true;
};

/// A dashed line of that slope on a log-log chart, through the middle of what is drawn: "error ~ dt^2".
struct SlopeGuide {
    double slope = 1;
    std::string name{};
};

/// Marks that stand on the x axis: when something happened.
struct Marks {
    std::string name{};
    std::vector<double> x{};
};

/// A chart of points and lines, or of bars (`bars`: one for each point, named by its label; x is not used).
struct Chart {
    std::string id{};  ///< unique on the page: letters, digits and dashes
    std::string title{};
    std::string x_label{};  ///< with its unit: "time (s)"
    std::string y_label{};
    bool log_x = false;
    bool log_y = false;
    std::vector<Series> series{};
    std::vector<SlopeGuide> slopes{};
    bool bars = false;
    bool follows_time =
        false;  ///< x is the time of a player on the page: the chart shows and sets its cursor
    Marks marks{};
    std::string note{};  ///< a sentence below
};

/// A table of texts; a column whose cells are numbers (digits may be followed by a unit) sorts as numbers.
struct Table {
    std::string caption{};
    std::vector<std::string> headers{};
    std::vector<std::vector<std::string>> rows{};
    bool sortable = false;
};

/// A self-contained HTML page: scripts and styles are inside, nothing is fetched. Texts are shown as they
/// are, never as markup. Light or dark as the reader's system says; readable from 390 pixels of width up.
class Page {
  public:
    explicit Page(std::string title) : title_(std::move(title)) {}

    void heading(std::string text);
    void paragraph(const std::string& text);
    /// Stands out, and comes first whenever it is added: what a reader must know before the numbers.
    void warning(const std::string& text);
    void chart(Chart chart);
    void table(const Table& table);

    /// Markup as it is, written when the page is: for parts too large to hold. Scripts of `assets` find it
    /// there.
    void block(std::function<void(std::ostream&)> write);

    /// All of another page under its title as a heading. Charts keep their ids, with `prefix` before them.
    void append(Page section, const std::string& prefix);

    const std::string& title() const { return title_; }
    void set_title(std::string title) { title_ = std::move(title); }

    /// Writes the page piece by piece. Memory: that of the largest chart's text, beside what was added.
    void write(std::ostream& out) const;
    std::string html() const;

  private:
    void add(std::string html);

    std::string title_;
    std::vector<std::string> warnings_;
    struct Part {
        std::function<void(std::ostream&)> write;
        std::optional<Chart> chart{};  ///< in place of the above; neighbours stand side by side
    };
    std::vector<Part> parts_;
};

/// The chart as the page's script reads it.
Json chart_json(const Chart& chart);

}  // namespace carom::report
