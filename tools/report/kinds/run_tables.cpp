#include "report/kinds/run_tables.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "report/readers/csv_reader.hpp"
#include "report/readers/h5_reader.hpp"

namespace carom::report {
namespace {

constexpr std::size_t kMostTableRows = 1000;

/// With so many decimals, and without the sign of a zero.
std::string fixed(double value, int decimals) {
    std::array<char, 400> text;
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
    if (std::strtod(text.data(), nullptr) == 0)
        std::snprintf(text.data(), text.size(), "%.*f", decimals, 0.0);
    return text.data();
}

std::string rounded(double value) {
    std::array<char, 40> text;
    std::snprintf(text.data(), text.size(), "%.6g", value);
    return text.data();
}

void add_effects(const Json& plan, Page& page) {
    Table table{.caption = "What the scene called for, and why", .headers = {"effect", "on", "reason"}};
    for (const Json& effect : plan.at("effects"))
        table.rows.push_back({plain(effect.at("name")), effect.at("on").get<bool>() ? "on" : "off",
                              plain(effect.at("reason"))});
    page.table(table);
}

void add_settings(const Json& summary, Page& page) {
    Table table{.caption = "Settings", .headers = {"setting", "value"}};
    const auto add = [&table](const char* name, const std::string& value) {
        table.rows.push_back({name, value});
    };
    add("bodies", plain(summary.at("bodies")));
    add("steps", plain(summary.at("steps")));
    add("step length", rounded(number_of(summary.at("dt"))) + " s");
    add("time simulated", rounded(number_of(summary.at("time"))) + " s");
    for (const char* key : {"solver", "substeps", "iterations", "precision"})
        add(key, plain(summary.at(key)));
    add("instruction set", plain(summary.at("isa")));
    add("threads", plain(summary.at("threads")));
    add("time taken", rounded(1e3 * number_of(summary.at("wall").at("total_s"))) + " ms");
    add("a step", rounded(number_of(summary.at("wall").at("ms_per_step"))) + " ms");
    add("a body and step", rounded(number_of(summary.at("wall").at("ns_per_body_step"))) + " ns");
    add("hash of the final state", plain(summary.at("state_hash")));
    add("version of Carom", plain(summary.at("version")));
    page.table(table);
}

void add_course(const Json& summary, Page& page) {
    Table table{.caption = "Energy and momentum", .headers = {"", "start", "first step", "end"}};
    const auto add = [&table](const std::string& name, const Json& course, const auto& part) {
        const auto cell = [&](const char* moment) {
            return course.contains(moment) ? rounded(part(course.at(moment))) : std::string();
        };
        table.rows.push_back({name, cell("initial"), cell("after_first_step"), cell("final")});
    };
    for (const char* kind : {"kinetic", "rotational", "potential", "total"})
        add(kind + std::string(" energy (J)"), summary.at("energy"),
            [kind](const Json& energy) { return number_of(energy.at(kind)); });
    for (const auto& [name, axis] :
         {std::pair{"momentum x (kg m/s)", std::size_t{0}}, {"momentum y (kg m/s)", 1}})
        add(name, summary.at("momentum"), [axis = axis](const Json& p) { return number_of(p.at(axis)); });
    add("angular momentum (kg m\u00b2/s)", summary.at("angular_momentum"),
        [](const Json& p) { return number_of(p); });
    page.table(table);
}

void add_accuracy(const Json& summary, Page& page) {
    Table table{.caption = "Accuracy", .headers = {"figure", "value", "unit"}};
    const Json& contacts = summary.at("contacts");
    const auto overlap = [&contacts](const char* key) { return rounded(100 * number_of(contacts.at(key))); };
    if (summary.contains("energy_by_cause"))
        table.rows.push_back({"energy that no cause explains",
                              rounded(number_of(summary.at("energy_by_cause").at("unexplained"))), "J"});
    if (summary.contains("energy_excess"))
        for (const auto& [rule, excess] : summary.at("energy_excess").items())
            if (number_of(excess) > 0)
                table.rows.push_back({rule == "passive" ? "energy above the start, undriven"
                                                        : "energy from " + rule + ", most in a step",
                                      rounded(number_of(excess)), "J"});
    table.rows.push_back({"touching contacts at the end", plain(contacts.at("touching")), ""});
    table.rows.push_back({"their mean overlap", overlap("overlap_mean"), "% of the smaller radius"});
    table.rows.push_back({"their largest overlap", overlap("overlap_max"), "% of the smaller radius"});
    const Json& counters = summary.at("counters");
    table.rows.push_back({"impacts", plain(counters.at("impacts")), ""});
    table.rows.push_back({"of these at walls", plain(counters.at("wall_impacts")), ""});
    table.rows.push_back({"left unresolved by a step", plain(counters.at("unresolved_impacts")), ""});
    if (counters.value("asleep", 0) > 0)
        table.rows.push_back({"asleep at the end", plain(counters.at("asleep")), "bodies"});
    page.table(table);
}

/// Masses and moments of inertia, where there is a trajectory to tell them.
struct Inertias {
    std::vector<double> mass, inertia;

    explicit Inertias(const RunFiles& files) {
        if (files.trajectory_h5.empty()) return;
        const H5Reader trajectory(files.trajectory_h5);
        mass = trajectory.body_column("mass");
        if (trajectory.has("inertia")) inertia = trajectory.body_column("inertia");
    }

    std::string kinetic_energy(std::size_t body, double vx, double vy, double omega) const {
        if (body >= mass.size()) return "";
        const double turning = body < inertia.size() ? inertia[body] * omega * omega : 0;
        return fixed(0.5 * (mass[body] * (vx * vx + vy * vy) + turning), 3);
    }
};

}  // namespace

void add_summary_tables(const Json& summary, Page& page) {
    const auto plan = summary.find("plan");
    if (plan != summary.end()) {
        page.paragraph("Solver " + plain(summary.at("solver")) + ": " +
                       plain(plan->at("solver").at("reason")) + ".");
        add_effects(*plan, page);
    }
    add_course(summary, page);
    add_accuracy(summary, page);
    add_settings(summary, page);
}

void add_body_table(const RunFiles& files, Page& page) {
    Table table{.caption = "Bodies at the end",
                .headers = {"body", "name", "x (m)", "y (m)", "vx (m/s)", "vy (m/s)", "energy (J)",
                            "angle (rad)", "spin (rad/s)"},
                .sortable = true};
    const Inertias inertias(files);
    bool more = false, named = false;
    std::size_t lines = 0;
    read_csv(files.final_csv, [&](const CsvRow& row) {
        if (lines++ == 0 || row.size() < 8) return true;
        more = table.rows.size() == kMostTableRows;
        if (more) return false;
        const auto value = [&row](std::size_t column) {
            double number = NAN;
            std::from_chars(row[column].data(), row[column].data() + row[column].size(), number);
            return number;
        };
        table.rows.push_back({row[0], row[1], fixed(value(2), 2), fixed(value(3), 2), fixed(value(5), 2),
                              fixed(value(6), 2),
                              inertias.kinetic_energy(table.rows.size(), value(5), value(6), value(7)),
                              fixed(value(4), 3), fixed(value(7), 3)});
        named = named || !row[1].empty();
        return true;
    });
    if (!named) {
        table.headers.erase(table.headers.begin() + 1);
        for (auto& row : table.rows) row.erase(row.begin() + 1);
    }
    if (more) table.caption += ", the first " + std::to_string(kMostTableRows);
    page.table(table);
}

}  // namespace carom::report
