// SPDX-License-Identifier: Apache-2.0
#include "scene/formats/gltf_buffers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <system_error>

namespace fasttree::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t kNoDigit = 0xff;

constexpr std::array<std::uint8_t, 256> base64_digits() {
  std::array<std::uint8_t, 256> digits = {};
  digits.fill(kNoDigit);
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  }
  return digits;
}
constexpr std::array<std::uint8_t, 256> kDigits = base64_digits();

/// Decodes base64 (RFC 4648, padding optional). False where a character is none of its.
bool decode_base64(std::string_view text, std::vector<std::byte>& out) {
  while (text.ends_with('=')) text.remove_suffix(1);
  if (text.size() % 4 == 1) return false;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const std::uint8_t digit = kDigits[static_cast<unsigned char>(c)];
    if (digit == kNoDigit) return false;
    bits = (bits << 6 | digit) & 0xffffu;
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      out.push_back(static_cast<std::byte>(bits >> bit_count & 0xffu));
    }
  }
  return true;
}

/// Replaces %20 and its like. False where a % is not followed by two hexadecimal digits.
bool decode_percent(std::string_view uri, std::string& out) {
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      out += uri[i];
      continue;
    }
    unsigned value = 0;
    const char* const digits = uri.data() + i + 1;
    if (uri.size() - i < 3 || std::from_chars(digits, digits + 2, value, 16).ptr != digits + 2) {
      return false;
    }
    out += static_cast<char>(value);
    i += 2;
  }
  return true;
}

/// Whether a relative path names something below the folder it starts from, by its text alone.
bool stays_below(const std::string& path) {
  if (path.empty() || path.front() == '/') return false;
  for (const char c : path) {
    // A backslash is a separator on other systems, a colon begins a scheme or a drive.
    if (c == '\\' || c == ':' || c == '\0') return false;
  }
  const fs::path parts(path);
  return std::none_of(parts.begin(), parts.end(),
                      [](const fs::path& part) { return part == ".."; });
}

}  // namespace

Result<std::span<const std::byte>> GltfBuffers::view(std::size_t index) {
  const GltfBufferView& view = document_.views[index];
  if (!buffers_[view.buffer].ready) {
    if (Status s = read(view.buffer); !s.ok()) return s;
  }
  // The document has checked that the view lies in byteLength, and `read` that byteLength is there.
  return buffers_[view.buffer].bytes.subspan(view.byte_offset, view.byte_length);
}

Status GltfBuffers::read(std::size_t index) {
  const GltfBuffer& described = document_.buffers[index];
  const std::string path = "buffers[" + std::to_string(index) + "]";
  Buffer& buffer = buffers_[index];
  if (!described.uri) {
    if (index != 0 || !binary_chunk_) {
      return bad_input(source_, path + " has no uri, and the file has no binary chunk for it.");
    }
    buffer.bytes = *binary_chunk_;
  } else {
    const std::string_view uri = *described.uri;
    const Status status = uri.starts_with("data:") ? read_base64(path, uri, buffer)
                                                   : read_file(path, *described.uri, buffer);
    if (!status.ok()) return status;
  }
  if (buffer.bytes.size() < described.byte_length) {
    return bad_input(source_, path + " has " + std::to_string(buffer.bytes.size()) +
                                  " bytes, but byteLength says " +
                                  std::to_string(described.byte_length) +
                                  ". The file is truncated, or its header is wrong.");
  }
  buffer.ready = true;
  return {};
}

Status GltfBuffers::read_base64(const std::string& path, std::string_view uri, Buffer& buffer) {
  constexpr std::string_view kMark = ";base64";
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(kMark)) {
    return bad_input(source_, path +
                                  ".uri holds data that is not base64. Export the buffer as "
                                  "base64 or as a file.");
  }
  const std::string_view text = uri.substr(comma + 1);
  if (Status s = budget_.claim(text.size() / 4 * 3 + 2, "a decoded buffer"); !s.ok()) return s;
  if (!decode_base64(text, buffer.decoded)) {
    return bad_input(source_, path + ".uri is not valid base64. The file is damaged.");
  }
  buffer.bytes = buffer.decoded;
  bytes_read_ += buffer.decoded.size();
  return {};
}

// Only from below the glTF's own folder: a scene from a stranger must not be able to read others.
Status GltfBuffers::read_file(const std::string& path, const std::string& uri, Buffer& buffer) {
  const std::string advice = ". A buffer has to lie in the glTF's own folder.";
  std::string relative;
  if (!decode_percent(uri, relative) || !stays_below(relative)) {
    return bad_input(source_, path + ".uri is " + excerpt(uri) + advice);
  }
  if (source_.folder.empty()) {
    return bad_input(source_, path + ".uri is " + excerpt(uri) +
                                  ", but this glTF comes without a folder. Embed the buffer.");
  }
  // The text alone does not tell where a symbolic link leads.
  std::error_code error;
  const fs::path folder = fs::canonical(source_.folder, error);
  const fs::path file = error ? fs::path() : fs::canonical(folder / relative, error);
  if (error) {
    return {StatusCode::io_error, source_.name + ": " + path + ".uri, " + excerpt(uri) + ": " +
                                      error.message() + ". Put the file beside the glTF."};
  }
  const auto [folder_end, file_at] =
      std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  if (folder_end != folder.end()) {
    return bad_input(source_, path + ".uri, " + excerpt(uri) + ", leads elsewhere" + advice);
  }
  const Result<std::shared_ptr<const MappedFile>> mapped = MappedFile::open(file.string());
  if (!mapped.ok()) return mapped.status();
  buffer.file = mapped.value();
  buffer.bytes = buffer.file->bytes();
  bytes_read_ += buffer.bytes.size();
  return {};
}

bool GltfBuffers::still_whole() const {
  return std::all_of(buffers_.begin(), buffers_.end(), [](const Buffer& buffer) {
    return buffer.file == nullptr || buffer.file->still_whole();
  });
}

}  // namespace fasttree::scene
