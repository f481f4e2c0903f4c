#pragma once

#include <carom/scene.hpp>

#include <string>

#include "report/kinds/run_page.hpp"
#include "results/result_folder.hpp"
#include "results/run_outcome.hpp"
#include "run_settings.hpp"

namespace carom::tool {

struct RunChoices {
    bool no_trajectory = false;
    bool no_report = false;
    std::size_t page_bytes = report::kDefaultPageBytes;  ///< of report.html
    bool events = false;                                 ///< write events.csv
    bool quiet = false;
    std::string scene_text;  ///< for the trajectory's notes
};

/// Steps the simulation as often as the scene says, or until it is interrupted, and writes the result files.
/// @throws WriteError; the folder is then as it was.
RunOutcome run_scene(const Scene& scene, Simulation& simulation, ResultFolder& folder,
                     const RunChoices& choices);

/// The scene's name as the name of a folder: no separators, no leading dots, of sensible length.
std::string folder_name(const std::string& scene_name);

/// The text of a file, or nothing if it is no ordinary one.
std::string text_of_file(const std::string& path);

}  // namespace carom::tool
