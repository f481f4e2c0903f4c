#pragma once

#include <string>
#include <vector>

namespace carom::report {

/// One cell of a heat map. Its colour is a level; what it says is text, so that no colour is needed to read
/// it.
struct HeatCell {
    std::string text{};   ///< empty: there is no such cell
    std::string small{};  ///< below, in small letters
    std::string hover{};
    int level = -1;          ///< 0 (coolest) to kHeatLevels - 1; below 0: no colour
    bool is_struck = false;  ///< hatched: nothing was measured
};

inline constexpr int kHeatLevels = 9;

struct HeatRow {
    std::string name{}, small{};
    std::vector<HeatCell> cells{};
};

/// A table whose cells are coloured. Columns that follow each other with one `group` have it above them.
struct HeatMap {
    struct Column {
        std::string group{}, name{};
    };
    std::string caption{};
    std::string corner{};  ///< above the names of the rows
    std::vector<Column> columns{};
    std::vector<HeatRow> rows{};
};

std::string heat_map_html(const HeatMap& map);

/// What the levels mean: a line of coloured texts, from the coolest on.
struct HeatKey {
    std::string text{};
    int level = -1;
    bool is_struck = false;
};
std::string heat_legend_html(const std::vector<HeatKey>& keys);

}  // namespace carom::report
