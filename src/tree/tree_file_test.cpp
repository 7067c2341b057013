// SPDX-License-Identifier: Apache-2.0
#include "fasttree/tree_file.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>

#include "tree/atomic_file.h"
#include "tree/test_trees.h"
#include "tree/xxh3.h"

namespace fasttree {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<char>;

constexpr std::size_t kHeaderBytes = 128;
constexpr std::size_t kChecksumAt = 88;

// A folder of its own for each test, removed with all that is in it.
class TreeFile : public testing::Test {
 protected:
  TreeFile() {
    std::string name = testing::TempDir() + "fasttree-XXXXXX";
    folder_ = ::mkdtemp(name.data());
  }
  ~TreeFile() override { fs::remove_all(folder_); }

  std::string path(const char* name = "a.tree") const { return folder_ / name; }

  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  Bytes read(const std::string& from) const {
    std::ifstream in(from, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::string write(const Bytes& bytes, const char* name = "damaged.tree") const {
    std::ofstream out(path(name), std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path(name);
  }

  Bytes saved(const Tree& tree) const {
    EXPECT_TRUE(save_tree(tree, path()).ok());
    return read(path());
  }

  // Loads and maps; both have to refuse. Gives the message back.
  std::string refused(const std::string& from, StatusCode code = StatusCode::bad_input) const {
    const Status loaded = load_tree(from).status();
    const Status mapped = map_tree(from).status();
    EXPECT_EQ(loaded.code(), code) << loaded.message();
    EXPECT_EQ(mapped.code(), code) << mapped.message();
    EXPECT_EQ(loaded.message(), mapped.message());
    EXPECT_NE(loaded.message().find(from), std::string::npos) << "names the file";
    return loaded.message();
  }

  fs::path folder_;
};

Tree sample(std::uint64_t seed = 1, std::uint32_t leaves = 9) {
  test::Rng rng(seed);
  return test::random_shape(rng, leaves);
}

template <typename T>
void put(Bytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// Makes a changed file's checksum right again, as another writer would.
void fix_checksum(Bytes& bytes) {
  const auto all = std::as_bytes(std::span(bytes));
  Xxh3 hash;
  hash.bytes(all.first(kChecksumAt));
  hash.bytes(all.subspan(kChecksumAt + 8));
  put(bytes, kChecksumAt, hash.digest());
}

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

TEST_F(TreeFile, GivesBackWhatWasSaved) {
  ASSERT_TRUE(rc::check([this](std::uint64_t seed) {
    const Tree tree = sample(seed, *rc::gen::inRange<std::uint32_t>(1, 100));
    RC_ASSERT(save_tree(tree, path()).ok());
    RC_ASSERT(test::same(load_tree(path()).value(), tree));
    RC_ASSERT(test::same(map_tree(path()).value(), tree));
  }));
  EXPECT_EQ(files(), 1u) << "no temporary is left";
}

TEST_F(TreeFile, KeepsTheTreeOfAnEmptyMesh) {
  EXPECT_EQ(saved(Tree()).size(), kHeaderBytes + 8);
  EXPECT_TRUE(test::same(load_tree(path()).value(), Tree()));
  EXPECT_TRUE(test::same(map_tree(path()).value(), Tree()));
}

TEST_F(TreeFile, LayoutIsAsDocumented) {
  const Tree tree = sample();
  const Bytes bytes = saved(tree);
  const auto u64 = [&](std::size_t at) {
    std::uint64_t v;
    std::memcpy(&v, bytes.data() + at, 8);
    return v;
  };
  EXPECT_EQ(std::string(bytes.data(), 8), "FASTTREE");
  EXPECT_EQ(u64(8), std::uint64_t{0x01020304} << 32 | 1) << "version, byte order";
  EXPECT_EQ(u64(16), kHeaderBytes);
  EXPECT_EQ(u64(24), tree.nodes().size());
  EXPECT_EQ(u64(32), tree.ids().size());
  EXPECT_EQ(u64(40), tree.info().triangle_count);
  EXPECT_EQ(std::memcmp(bytes.data() + 48, &tree.info().bounds, 24), 0);
  EXPECT_EQ(bytes[72], static_cast<char>(tree.info().profile));
  EXPECT_EQ(bytes[73], static_cast<char>(tree.info().axes));
  EXPECT_EQ(bytes[74], static_cast<char>(tree.info().depth));
  EXPECT_EQ(std::memcmp(bytes.data() + 75, tree.info().bits.data(), 3), 0);
  EXPECT_EQ(u64(80), tree.hash());
  const std::size_t ids_at = kHeaderBytes + tree.nodes().size_bytes();
  EXPECT_EQ(
      std::memcmp(bytes.data() + kHeaderBytes, tree.nodes().data(), tree.nodes().size_bytes()), 0);
  EXPECT_EQ(std::memcmp(bytes.data() + ids_at, tree.ids().data(), tree.ids().size_bytes()), 0);
  EXPECT_EQ(bytes.size(), ids_at + tree.ids().size_bytes());
}

TEST_F(TreeFile, MappedTreeHasAlignedNodesAndOutlivesItsFile) {
  const Tree tree = sample(3, 1000);
  ASSERT_TRUE(save_tree(tree, path()).ok());
  std::optional<Tree> mapped = map_tree(path()).value();
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(mapped->nodes().data()) % 64, 0u);
  const Tree copy = *mapped;
  mapped.reset();
  fs::remove(path());
  EXPECT_TRUE(test::same(copy, tree));
}

TEST_F(TreeFile, TruncatedAnywhereIsRefused) {
  const Bytes whole = saved(sample());
  ASSERT_GT(whole.size(), kHeaderBytes);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string message =
        refused(write(Bytes(whole.begin(), whole.begin() + static_cast<long>(size))));
    EXPECT_TRUE(contains(message, "truncated")) << message;
    EXPECT_TRUE(contains(message, std::to_string(size).c_str())) << message;
  }
}

TEST_F(TreeFile, EverySingleBitFlipIsFound) {
  const Bytes whole = saved(sample());
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ 1 << bit % 8);
    const std::string damaged = write(bytes);
    ASSERT_EQ(load_tree(damaged).status().code(), StatusCode::bad_input) << "bit " << bit;
    ASSERT_EQ(map_tree(damaged).status().code(), StatusCode::bad_input) << "bit " << bit;
  }
}

TEST_F(TreeFile, BytesBehindTheEndAreRefused) {
  Bytes bytes = saved(sample());
  bytes.push_back(0);
  EXPECT_TRUE(contains(refused(write(bytes)), "1 bytes too many"));
}

// Counts that would be terabytes, or overflow, are refused by the file's size.
TEST_F(TreeFile, HugeCountsAreRefusedBeforeMemoryIsAsked) {
  const Bytes whole = saved(sample());
  for (const std::size_t at : {24u, 32u}) {
    for (const std::uint64_t count : {std::uint64_t{1} << 29, std::uint64_t{1} << 61,
                                      std::uint64_t{1} << 62, ~std::uint64_t{0}}) {
      Bytes bytes = whole;
      put(bytes, at, count);
      fix_checksum(bytes);
      EXPECT_TRUE(contains(refused(write(bytes)), "truncated"));
    }
  }
}

TEST_F(TreeFile, SoundFilesOfOthersAreRefusedWithTheReason) {
  const Bytes whole = saved(sample());
  const auto refused_with = [&](auto change) {
    Bytes bytes = whole;
    change(bytes);
    fix_checksum(bytes);
    return refused(write(bytes));
  };
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { b[0] = 'f'; }), "not a tree file"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { put<std::uint32_t>(b, 8, 2); }), "version 2"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { put<std::uint32_t>(b, 12, 0x04030201); }),
                       "other byte order"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { put<std::uint64_t>(b, 16, 192); }),
                       "header of 192 bytes"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { put<std::uint64_t>(b, 40, 1ull << 32); }),
                       "4294967296 triangles"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { b[72] = 4; }), "profile 4"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { b[73] = 2; }), "axis schedule 2"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { b[79] = 1; }), "reserved"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { b[127] = 1; }), "reserved"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { b[80] ^= 1; }), "its header says"));
  EXPECT_TRUE(contains(refused_with([](Bytes& b) { b[128] ^= 1; }), "its header says"));
}

TEST_F(TreeFile, WhatIsNoFileIsAnIoError) {
  EXPECT_TRUE(contains(refused(path("missing"), StatusCode::io_error), "No such file"));
  EXPECT_TRUE(contains(refused(folder_, StatusCode::io_error), "not a regular file"));
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_TRUE(contains(refused(path("pipe"), StatusCode::io_error), "not a regular file"));
  EXPECT_TRUE(contains(refused("/dev/null", StatusCode::io_error), "not a regular file"));
}

// Runs `work` in a child process, whose user, limits and mounts are its own. Its result, 0 to 255.
int in_child(const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int state = 0;
  ::waitpid(child, &state, 0);
  return WIFEXITED(state) ? WEXITSTATUS(state) : 255;
}

TEST_F(TreeFile, UnreadableIsAnIoError) {
  constexpr uid_t kNobody = 65534;
  ASSERT_TRUE(save_tree(Tree(), path()).ok());
  fs::permissions(path(), fs::perms::none);
  // Root reads every file, so that a test run as root gives its rights away first.
  const int code = in_child([this] {
    if (::geteuid() == 0 && ::setuid(kNobody) != 0) return 100;
    return is_tree_file(path()) ? 101 : static_cast<int>(load_tree(path()).status().code());
  });
  EXPECT_EQ(code, static_cast<int>(StatusCode::io_error));
}

TEST_F(TreeFile, IsRecognisedByItsBeginning) {
  const Bytes whole = saved(sample());
  EXPECT_TRUE(is_tree_file(path()));
  EXPECT_TRUE(is_tree_file(write(Bytes(whole.begin(), whole.begin() + 8))));
  EXPECT_FALSE(is_tree_file(write(Bytes(whole.begin(), whole.begin() + 7))));
  EXPECT_FALSE(is_tree_file(write({'p', 'l', 'y', '\n', 'f', 'o', 'r', 'm', 'a', 't'})));
  EXPECT_FALSE(is_tree_file(path("missing")));
  EXPECT_FALSE(is_tree_file(folder_));
}

TEST_F(TreeFile, SavingReplacesAFileAndNothingElse) {
  ASSERT_TRUE(save_tree(sample(1), path()).ok());
  ASSERT_TRUE(save_tree(sample(2), path()).ok());
  EXPECT_TRUE(test::same(load_tree(path()).value(), sample(2)));

  EXPECT_EQ(save_tree(Tree(), folder_).code(), StatusCode::io_error);
  EXPECT_EQ(save_tree(Tree(), "/dev/null").code(), StatusCode::io_error);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(save_tree(Tree(), path("no/such/folder.tree")).code(), StatusCode::io_error);
  EXPECT_EQ(files(), 1u);
}

TEST_F(TreeFile, SavesUnderARelativeName) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  const Status status = save_tree(sample(), "relative.tree");
  fs::current_path(before);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(test::same(load_tree(path("relative.tree")).value(), sample()));
}

TEST_F(TreeFile, AFileGivenUpLeavesNoTrace) {
  ASSERT_TRUE(save_tree(sample(), path()).ok());
  {
    Result<AtomicFile> file = AtomicFile::create(path());
    ASSERT_TRUE(file.ok());
    const AtomicFile moved = std::move(file).value();
    EXPECT_EQ(files(), 2u);
  }
  EXPECT_EQ(files(), 1u);
  EXPECT_TRUE(test::same(load_tree(path()).value(), sample()));
}

TEST_F(TreeFile, ANameTakenMeanwhileIsAnIoError) {
  Result<AtomicFile> file = AtomicFile::create(path());
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(fs::create_directory(path()));
  EXPECT_EQ(file.value().commit().code(), StatusCode::io_error);
}

TEST_F(TreeFile, AFullDiskKeepsTheOldFile) {
  const Tree old_tree = sample(1);
  ASSERT_TRUE(save_tree(old_tree, path()).ok());
  // A limit on the size of files fails in the middle of writing, as a full disk does.
  const int code = in_child([this] {
    const rlimit limit{4096, 4096};
    if (::signal(SIGXFSZ, SIG_IGN) == SIG_ERR || ::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 100;
    return static_cast<int>(save_tree(sample(2, 5000), path()).code());
  });
  EXPECT_EQ(code, static_cast<int>(StatusCode::resource_limit));
  EXPECT_EQ(files(), 1u) << "the temporary is removed";
  EXPECT_TRUE(test::same(load_tree(path()).value(), old_tree));
}

TEST_F(TreeFile, AFullFileSystemIsAResourceLimit) {
  constexpr int kCannotMount = 100;
  constexpr int kWrong = 101;
  const int code = in_child([this] {
    // As root a mount space of its own is enough; others need to be root in a user space first.
    const std::string user = "0 " + std::to_string(::geteuid()) + " 1";
    if (::unshare(CLONE_NEWNS) != 0) {
      if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return kCannotMount;
      std::ofstream("/proc/self/uid_map") << user;
    }
    // Private first, so that nothing outside sees the mount.
    if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("none", folder_.c_str(), "tmpfs", 0, "size=64k") != 0) {
      return kCannotMount;
    }
    if (!save_tree(sample(1), path()).ok()) return kWrong;
    const Status status = save_tree(sample(2, 50000), path());
    const bool kept = files() == 1 && test::same(load_tree(path()).value(), sample(1));
    return kept && contains(status.message(), "No space left") ? static_cast<int>(status.code())
                                                               : kWrong;
  });
  if (code == kCannotMount) GTEST_SKIP() << "this machine does not let a test mount a file system";
  EXPECT_EQ(code, static_cast<int>(StatusCode::resource_limit));
}

}  // namespace
}  // namespace fasttree
