#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "scene_file/nearest_name.hpp"
#include "terminal/exit_codes.hpp"

namespace carom::tool {
namespace {

/// Says what the first word is not, and which commands there are; CLI11 says only that one is required.
[[noreturn]] void refuse_command(const CLI::App& program) {
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::vector<std::string> words = program.remaining();
    if (words.empty()) {
        std::string list;
        for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
        throw UsageError("a command is needed, one of " + list + "; `carom --help` says what they do");
    }
    if (words.front().starts_with("-"))
        throw UsageError("there is no option \"" + words.front() + "\"; `carom --help` lists what there is");
    throw UsageError("\"" + words.front() + "\" is no command; " + known_names(words.front(), known));
}

/// Help and version texts are answers; everything else CLI11 throws is a wrong command line.
int answer(const CLI::App& program, const CLI::ParseError& error) {
    if (program.get_subcommands().empty() && dynamic_cast<const CLI::RequiredError*>(&error))
        refuse_command(program);
    return program.exit(error) == 0 ? kDone : kWrongInput;
}

}  // namespace

int run_program(int argc, char** argv) {
    CLI::App program("Carom, a 2D rigid-body physics engine: runs scenes and writes what happened.", "carom");
    Action action;
    program.require_subcommand(1);
    program.set_version_flag(
        "--version", [] { return version_text(); }, "Version, instruction sets, threads, and exit");
    add_run_command(program, action);
    add_explain_command(program, action);
    add_check_command(program, action);
    add_profile_command(program, action);
    add_prices_command(program, action);
    add_scaling_command(program, action);
    add_report_command(program, action);
    add_accuracy_command(program, action);
    add_torture_command(program, action);
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return answer(program, error);
    }
    return action();
}

}  // namespace carom::tool
