#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace carom::tool {

/// What the chosen subcommand does; returns the exit code.
using Action = std::function<int()>;

/// Each adds its subcommand; when that is the one on the command line, `action` becomes what it does.
void add_run_command(CLI::App& program, Action& action);
void add_explain_command(CLI::App& program, Action& action);
void add_check_command(CLI::App& program, Action& action);
void add_profile_command(CLI::App& program, Action& action);
void add_prices_command(CLI::App& program, Action& action);
void add_scaling_command(CLI::App& program, Action& action);
void add_report_command(CLI::App& program, Action& action);
void add_accuracy_command(CLI::App& program, Action& action);
void add_torture_command(CLI::App& program, Action& action);

/// Parses the command line and does what its subcommand says. @return the exit code
int run_program(int argc, char** argv);

/// Version, instruction sets, threads, xsimd: the answer to --version.
std::string version_text();

}  // namespace carom::tool
