#include "torture/run_tasks.hpp"

#include <poll.h>
#include <sys/mman.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "measure/text.hpp"
#include "torture/results.hpp"
#include "torture/watch.hpp"

namespace carom::torture {
namespace {

[[noreturn]] void fail(const char* what) {
    throw std::runtime_error(measure::joined("torture: ", what, ": ", std::strerror(errno)));
}

/// A step counter that parent and child both see.
class SharedCounter {
  public:
    SharedCounter() {
        void* const memory =
            mmap(nullptr, sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) fail("no shared memory");
        value_ = new (memory) std::int64_t(0);
    }
    ~SharedCounter() { munmap(value_, sizeof(std::int64_t)); }
    SharedCounter(const SharedCounter&) = delete;
    SharedCounter& operator=(const SharedCounter&) = delete;
    std::int64_t* get() { return value_; }

  private:
    std::int64_t* value_;
};

/// A child and the task it runs.
struct Running {
    pid_t process = -1;
    int pipe = -1;
    std::size_t task = 0;
    std::string text{};
    std::unique_ptr<SharedCounter> step{};
};

Outcome outcome_of(const Task& task) {
    try {
        return task.run();
    } catch (const std::exception& error) {
        return {.failure = error.what()};
    }
}

int answers = -1;  // of a child: its end of the pipe

/// A line of JSON. @return whether the parent has it
bool answer(const Outcome& outcome) {
    const std::string text = to_json(outcome).dump() + '\n';
    std::size_t written = 0;
    while (written < text.size()) {
        const ssize_t part = write(answers, text.data() + written, text.size() - written);
        if (part <= 0) return false;
        written += static_cast<std::size_t>(part);
    }
    return true;
}

[[noreturn]] void run_child(const Task& task, int pipe, std::int64_t* step) {
    // Ctrl-C goes to the whole group: the parent ends its children, and none of them looks as if it crashed.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
    std::signal(SIGPROF, SIG_DFL);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    watch_over_steps(step);
    answers = pipe;
    _exit(answer(outcome_of(task)) ? 0 : 1);
}

Running start(std::span<const Task> tasks, std::size_t index) {
    Running running{.task = index, .step = std::make_unique<SharedCounter>()};
    int ends[2];
    if (pipe(ends) != 0) fail("no pipe");
    running.pipe = ends[0];
    running.process = fork();
    if (running.process < 0) fail("no process");
    if (running.process == 0) {
        close(ends[0]);
        run_child(tasks[index], ends[1], running.step->get());
    }
    close(ends[1]);
    return running;
}

std::string reason_of(int status, std::int64_t step) {
    const auto number = static_cast<long long>(step) + 1;
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF)
        return measure::format("ended in step %lld, which took too long", number);
    if (WIFSIGNALED(status))
        return measure::format("crashed in step %lld: %s", number, strsignal(WTERMSIG(status)));
    return "ended without an answer";
}

/// @return whether there is nothing more to read
bool read_some(Running& running) {
    char part[65536];
    const ssize_t count = read(running.pipe, part, sizeof part);
    if (count > 0) running.text.append(part, static_cast<std::size_t>(count));
    return count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN);
}

/// The last whole line of what a child said, if there is one.
std::optional<Outcome> last_answer(const std::string& text) {
    const std::size_t end = text.rfind('\n');
    if (end == std::string::npos) return {};
    const std::size_t before = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    return outcome_from(Json::parse(text.substr(begin, end - begin)));
}

Outcome finish(Running& running) {
    close(running.pipe);
    int status = 0;
    while (waitpid(running.process, &status, 0) < 0 && errno == EINTR) {
    }
    std::optional<Outcome> last = last_answer(running.text);
    if (last && WIFEXITED(status) && WEXITSTATUS(status) == 0) return *std::move(last);
    Outcome outcome = std::move(last).value_or(Outcome{});
    if (outcome.bracket && WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF)
        outcome.bracket->is_out_of_time = true;
    else
        outcome.failure = reason_of(status, *running.step->get());
    return outcome;
}

void end_all(std::vector<Running>& all) {
    for (Running& running : all) {
        kill(running.process, SIGKILL);
        finish(running);
    }
    all.clear();
}

}  // namespace

void keep_so_far(const Outcome& outcome) {
    if (answers >= 0) answer(outcome);
}

std::vector<Row> run_tasks(std::span<const Task> tasks, int processes,
                           const std::function<void(std::size_t)>& report,
                           const std::function<bool()>& stop) {
    constexpr int kPatience = 100;  // ms between two looks at `stop`
    std::vector<std::optional<Outcome>> outcomes(tasks.size());
    std::vector<Running> all;
    std::size_t next = 0, done = 0;
    while ((next < tasks.size() || !all.empty()) && !stop()) {
        while (next < tasks.size() && all.size() < static_cast<std::size_t>(processes))
            all.push_back(start(tasks, next++));
        std::vector<pollfd> pipes;
        for (const Running& running : all) pipes.push_back({running.pipe, POLLIN, 0});
        poll(pipes.data(), pipes.size(), kPatience);
        for (std::size_t i = all.size(); i-- > 0;) {
            if ((pipes[i].revents & (POLLIN | POLLHUP | POLLERR)) == 0 || !read_some(all[i])) continue;
            outcomes[all[i].task] = finish(all[i]);
            all.erase(all.begin() + static_cast<std::ptrdiff_t>(i));
            report(++done);
        }
    }
    end_all(all);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < tasks.size(); ++i)
        if (outcomes[i])
            rows.push_back({tasks[i].case_id, tasks[i].scene, tasks[i].solver, tasks[i].precision,
                            std::move(*outcomes[i])});
    return rows;
}

}  // namespace carom::torture
