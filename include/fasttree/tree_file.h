// SPDX-License-Identifier: Apache-2.0
// Trees in files: versioned, checksummed, loadable or mappable. Layout: docs/tree.md.
#pragma once

#include <string>

#include "fasttree/status.h"
#include "fasttree/tree.h"

namespace fasttree {

/// Writes the tree to a temporary name beside `path`, flushes it and renames it into place, so that
/// `path` holds either what it held before or the whole tree.
/// io_error: cannot create or write; resource_limit: the disk is full.
Status save_tree(const Tree& tree, const std::string& path);

/// Reads a tree file into memory of its own and checks sizes and checksum.
/// io_error: cannot open or read; bad_input: not a tree file, another version, truncated, damaged.
/// The content's invariants are a matter for verify().
Result<Tree> load_tree(const std::string& path);

/// The same without copying: the file is mapped read-only and stays mapped while a copy of the tree
/// lives. The file must not be changed meanwhile.
Result<Tree> map_tree(const std::string& path);

/// Whether the file begins as a tree file does. False where it cannot be read.
bool is_tree_file(const std::string& path);

}  // namespace fasttree
