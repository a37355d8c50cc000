#pragma once
// Makes NumPy files for tests, byte by byte as the format's description says.

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace collidoscope {

/// `dictionary` is padded with spaces and ends in a newline, as NumPy writes it.
inline std::string npy_bytes(const std::string& dictionary, const std::string& data, int version = 1) {
  const std::size_t begin = version == 1 ? 10 : 12;
  std::string header = dictionary;
  while ((begin + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (std::size_t k = 0; k < begin - 8; ++k) bytes += static_cast<char>(header.size() >> 8 * k & 255);
  return bytes + header + data;
}

template <class Number>
std::string data_of(const std::vector<Number>& numbers) {
  std::string data(numbers.size() * sizeof(Number), '\0');
  if (!numbers.empty()) std::memcpy(data.data(), numbers.data(), data.size());
  return data;
}

inline std::string write_npy(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
  return file.string();
}

/// Boxes as six numbers each.
inline std::string box_file(const std::filesystem::path& file, const std::vector<float>& numbers) {
  return write_npy(file, npy_bytes("{'descr': '<f4', 'fortran_order': False, 'shape': (" +
                                       std::to_string(numbers.size() / 6) + ", 6), }",
                                   data_of(numbers)));
}

}  // namespace collidoscope
