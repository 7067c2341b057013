// SPDX-License-Identifier: Apache-2.0
#include "runner.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace fasttree::cli {
namespace {

/// Whether the process has a handler for the signal by now.
bool catches(int pid, int signal) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("SigCgt:", 0) == 0) {
      return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0;
    }
  }
  return false;
}

/// Reads both pipes to their ends, whichever has something.
void read_all(std::array<int, 2> descriptors, std::array<std::string*, 2> texts) {
  std::size_t open = 2;
  while (open > 0) {
    std::array<pollfd, 2> polled = {pollfd{descriptors[0], POLLIN, 0},
                                    pollfd{descriptors[1], POLLIN, 0}};
    poll(polled.data(), polled.size(), -1);
    for (std::size_t i = 0; i < 2; ++i) {
      if (descriptors[i] < 0 || polled[i].revents == 0) continue;
      std::array<char, 4096> buffer{};
      const ssize_t n = read(descriptors[i], buffer.data(), buffer.size());
      if (n > 0) {
        texts[i]->append(buffer.data(), static_cast<std::size_t>(n));
      } else {
        close(descriptors[i]);
        descriptors[i] = -1;
        --open;
      }
    }
  }
}

}  // namespace

nlohmann::json RunResult::json() const {
  return nlohmann::json::parse(out);
}

RunResult run(const std::vector<std::string>& arguments, const RunSettings& settings) {
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  std::vector<std::string> words = {FASTTREE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error("no process");
  if (pid == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    if (!settings.stdout_path.empty()) {
      const int file = open(settings.stdout_path.c_str(), O_WRONLY | O_CLOEXEC);
      if (file < 0 || dup2(file, STDOUT_FILENO) < 0) _exit(126);
    }
    if (settings.prepare) settings.prepare();
    execv(FASTTREE_PROGRAM, argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  std::thread helper;
  if (settings.meanwhile) {
    helper = std::thread([&] {
      for (int i = 0; i < 6000 && !catches(pid, SIGINT); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      settings.meanwhile(pid);
    });
  }
  RunResult result;
  read_all({out[0], err[0]}, {&result.out, &result.err});
  if (helper.joinable()) helper.join();
  int status = 0;
  waitpid(pid, &status, 0);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

nlohmann::json run_json(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--json", "-"});
  const RunResult result = run(arguments);
  if (result.exit_code != 0) {
    throw std::runtime_error("exit " + std::to_string(result.exit_code) + ": " + result.err);
  }
  return result.json();
}

Background::Background(const std::vector<std::string>& arguments) {
  std::array<int, 2> out{};
  if (pipe2(out.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  std::vector<std::string> words = {FASTTREE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("no process");
  if (pid_ == 0) {
    dup2(out[1], STDOUT_FILENO);
    execv(FASTTREE_PROGRAM, argv.data());
    _exit(127);
  }
  close(out[1]);
  pipe_ = out[0];
}

Background::~Background() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    wait();
  }
  close(pipe_);
}

bool Background::read_more() {
  std::array<char, 4096> buffer{};
  const ssize_t n = read(pipe_, buffer.data(), buffer.size());
  if (n > 0) out_.append(buffer.data(), static_cast<std::size_t>(n));
  return n > 0;
}

bool Background::read_until(const std::string& text) {
  for (;;) {
    const std::size_t at = out_.find(text);
    if (at != std::string::npos && out_.find('\n', at) != std::string::npos) return true;
    if (!read_more()) return false;
  }
}

std::string Background::word_after(const std::string& text) const {
  const std::size_t at = out_.find(text);
  if (at == std::string::npos) return "";
  const std::size_t begin = out_.find_first_not_of(' ', at + text.size());
  return out_.substr(begin, out_.find_first_of(" \n", begin) - begin);
}

void Background::signal(int number) {
  if (pid_ > 0) kill(pid_, number);  // -1 would be everybody
}

int Background::wait() {
  while (read_more()) {
  }
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "fasttree_cli_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for the test");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::size_t Folder::file_count() const {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_),
                                                std::filesystem::directory_iterator()));
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

std::string real_scene(const std::string& name) {
  const std::string path = std::string(FASTTREE_SCENES) + "/" + name;
  return std::filesystem::exists(path) ? path : "";
}

}  // namespace fasttree::cli
