#include "lancet/experiments/common/process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

using Clock = std::chrono::steady_clock;
using Deadline = std::optional<Clock::time_point>;

[[noreturn]] void fail(const std::string& what, int cause) {
    throw Error(what + ": " + std::strerror(cause));
}

class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { close(); }

    [[nodiscard]] int number() const { return number_; }
    void close() {
        if (number_ >= 0) ::close(number_);
        number_ = -1;
    }

  private:
    int number_;
};

class FileActions {
  public:
    FileActions() {
        if (const int cause = ::posix_spawn_file_actions_init(&actions_)) fail("cannot prepare a process", cause);
    }
    FileActions(const FileActions&) = delete;
    FileActions& operator=(const FileActions&) = delete;
    ~FileActions() { ::posix_spawn_file_actions_destroy(&actions_); }

    [[nodiscard]] posix_spawn_file_actions_t* get() { return &actions_; }

  private:
    posix_spawn_file_actions_t actions_{};
};

/// A started program; kills and reaps it when an exception leaves the caller.
class Child {
  public:
    explicit Child(pid_t id) : id_(id) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (status_) return;
        kill();
        while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }

    void kill() const { ::kill(id_, SIGKILL); }

    int wait() {
        while (!status_) poll_status(0);
        return *status_;
    }

    /// Whether it ended before the deadline.
    bool wait_until(const Deadline& deadline) {
        if (!deadline) {
            wait();
            return true;
        }
        constexpr std::chrono::milliseconds pause(2);
        while (!status_) {
            poll_status(WNOHANG);
            if (status_) break;
            if (Clock::now() >= *deadline) return false;
            std::this_thread::sleep_for(pause);
        }
        return true;
    }

  private:
    void poll_status(int flags) {
        int status = 0;
        const pid_t ended = ::waitpid(id_, &status, flags);
        if (ended == id_) status_ = status;
        if (ended < 0 && errno != EINTR) fail("cannot wait for a process", errno);
    }

    pid_t id_;
    std::optional<int> status_;
};

std::vector<char*> pointers(std::vector<std::string>& strings) {
    std::vector<char*> result;
    result.reserve(strings.size() + 1);
    for (std::string& text : strings) result.push_back(text.data());
    result.push_back(nullptr);
    return result;
}

std::vector<std::string> merged_environment(const Command& command) {
    std::vector<std::string> result;
    for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
        const std::string text(*entry);
        const std::string name = text.substr(0, text.find('='));
        const bool replaced = std::any_of(command.environment.begin(), command.environment.end(),
                                          [&name](const auto& variable) { return variable.first == name; });
        if (!replaced) result.push_back(text);
    }
    for (const auto& [name, value] : command.environment) {
        result.push_back(name);
        result.back().append("=").append(value);
    }
    return result;
}

pid_t start(const Command& command, int output) {
    FileActions actions;
    int cause = ::posix_spawn_file_actions_addopen(actions.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (cause == 0) cause = ::posix_spawn_file_actions_adddup2(actions.get(), output, STDOUT_FILENO);
    if (cause != 0) fail("cannot prepare a process", cause);

    std::vector<std::string> arguments{command.program.string()};
    arguments.insert(arguments.end(), command.arguments.begin(), command.arguments.end());
    std::vector<std::string> environment = merged_environment(command);

    pid_t id = 0;
    cause = ::posix_spawnp(&id, arguments.front().c_str(), actions.get(), nullptr, pointers(arguments).data(),
                           pointers(environment).data());
    if (cause != 0) fail("cannot start '" + command.program.string() + "'", cause);
    return id;
}

int remaining_milliseconds(const Deadline& deadline) {
    if (!deadline) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*deadline - Clock::now()).count();
    // Far deadlines are waited for in pieces: poll() counts in int.
    return static_cast<int>(std::clamp<decltype(left)>(left, 0, 3'600'000));
}

/// Appends all that arrives; returns whether the end of the stream came before the deadline.
bool read_until(int descriptor, const Deadline& deadline, std::string& text) {
    std::array<char, 65536> buffer{};
    for (;;) {
        pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
        const int ready = ::poll(&waiting, 1, remaining_milliseconds(deadline));
        if (ready < 0 && errno != EINTR) fail("cannot read the output of a process", errno);
        if (ready == 0 && deadline && Clock::now() >= *deadline) return false;
        if (ready <= 0) continue;
        const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
        if (count < 0 && errno != EINTR) fail("cannot read the output of a process", errno);
        if (count == 0) return true;
        if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
    }
}

}  // namespace

bool ProcessResult::succeeded() const {
    const auto* exited = std::get_if<Exited>(&end);
    return exited != nullptr && exited->code == 0;
}

ProcessResult run_process(const Command& command) {
    const Deadline deadline = command.timeout ? Deadline(Clock::now() + *command.timeout) : std::nullopt;
    std::array<int, 2> ends{};
    // Close-on-exec: another program started meanwhile must not hold the pipe open. dup2 clears the flag in the child.
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("cannot make a pipe", errno);
    const Descriptor reading(ends[0]);
    Descriptor writing(ends[1]);
    Child child(start(command, writing.number()));
    writing.close();

    ProcessResult result;
    // The end of a killed program is the end of its output. Behind this block it may have been waited for, and its
    // number be another's.
    const bool is_read = [&] {
        const std::stop_callback kill_it(command.stop, [&child] { child.kill(); });
        return read_until(reading.number(), deadline, result.output);
    }();
    if (!is_read || !child.wait_until(deadline)) {
        child.kill();
        child.wait();
        result.end = TimedOut{};
        return result;
    }
    const int status = child.wait();
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL && command.stop.stop_requested()) {
        result.end = Stopped{};
    } else if (WIFSIGNALED(status)) {
        result.end = Signalled{WTERMSIG(status)};
    } else {
        result.end = Exited{WEXITSTATUS(status)};
    }
    return result;
}

std::string describe(const ProcessEnd& end) {
    if (const auto* exited = std::get_if<Exited>(&end)) return "exit code " + std::to_string(exited->code);
    if (const auto* signalled = std::get_if<Signalled>(&end)) {
        return "signal " + std::to_string(signalled->number) + " (" + ::strsignal(signalled->number) + ")";
    }
    return std::holds_alternative<Stopped>(end) ? "stopped" : "killed after its time limit";
}

std::filesystem::path this_program() {
    std::error_code error;
    std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) throw Error("cannot find the file of the running program: " + error.message());
    return program;
}

}  // namespace lancet::experiments
