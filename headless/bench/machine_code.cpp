#include "headless/bench/machine_code.h"

#include <elf.h>

#include <cstring>
#include <string_view>
#include <vector>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

constexpr std::string_view text_prefix = ".text.", constant_prefix = ".nv.constant0.";

/// One record at `at`; a file that ends before it does is damaged.
template <class Record>
Record read(std::string_view bytes, std::size_t at) {
  Record record;
  if (at > bytes.size() || bytes.size() - at < sizeof record)
    throw InputError("its machine code is cut short");
  std::memcpy(&record, bytes.data() + at, sizeof record);
  return record;
}

struct Section {
  Elf64_Shdr header;
  std::string_view name, bytes;
};

std::string_view string_at(std::string_view table, std::size_t at) {
  if (at >= table.size()) throw InputError("its machine code is damaged");
  return table.substr(at, table.find('\0', at) - at);
}

std::vector<Section> sections_of(std::string_view elf) {
  const auto header = read<Elf64_Ehdr>(elf, 0);
  std::vector<Section> sections;
  for (std::size_t k = 0; k < header.e_shnum; ++k) {
    const auto one = read<Elf64_Shdr>(elf, header.e_shoff + k * sizeof(Elf64_Shdr));
    std::string_view bytes;
    if (one.sh_type != SHT_NOBITS) {
      if (one.sh_offset > elf.size() || one.sh_size > elf.size() - one.sh_offset)
        throw InputError("its machine code is cut short");
      bytes = elf.substr(one.sh_offset, one.sh_size);
    }
    sections.push_back({one, {}, bytes});
  }
  if (header.e_shstrndx >= sections.size()) throw InputError("its machine code is damaged");
  const std::string_view names = sections[header.e_shstrndx].bytes;
  for (Section& section : sections) section.name = string_at(names, section.header.sh_name);
  return sections;
}

/// Mangled, a file's own namespace is `<length>_GLOBAL__N__<hash>_..._<hash>_<number>`.
std::string without_own_namespace(std::string_view name) {
  constexpr std::string_view own = "_GLOBAL__N__";
  std::string text(name);
  for (std::size_t at = text.find(own); at != text.npos; at = text.find(own, at + 1)) {
    std::size_t first = at;
    while (first > 0 && text[first - 1] >= '0' && text[first - 1] <= '9') --first;
    if (first == at) continue;
    const std::size_t length = std::stoul(text.substr(first, at - first));
    text.replace(first, at - first + length, "8own_file");
    at = first;
  }
  return text;
}

/// Section .nv.info: of each attribute its form, its number, and the size of what follows. Number 0x2f is a
/// kernel's registers: its symbol, and how many.
std::map<std::string, int> registers_of(const std::vector<Section>& sections) {
  std::string_view info, symbols, names;
  for (const Section& s : sections) {
    if (s.name == ".nv.info") info = s.bytes;
    if (s.header.sh_type == SHT_SYMTAB && s.header.sh_link < sections.size()) {
      symbols = s.bytes;
      names = sections[s.header.sh_link].bytes;
    }
  }
  std::map<std::string, int> registers;
  constexpr std::uint8_t sized = 4, register_count = 0x2f;
  for (std::size_t at = 0; at + 4 <= info.size();) {
    const auto form = read<std::uint8_t>(info, at), number = read<std::uint8_t>(info, at + 1);
    const std::size_t size = form == sized ? read<std::uint16_t>(info, at + 2) : 0;
    if (form == sized && number == register_count) {
      const auto symbol = read<Elf64_Sym>(symbols, read<std::uint32_t>(info, at + 4) * sizeof(Elf64_Sym));
      registers[std::string(string_at(names, symbol.st_name))] =
          static_cast<int>(read<std::uint32_t>(info, at + 8));
    }
    at += 4 + size;
  }
  return registers;
}

void add_kernels(std::string_view elf, std::map<std::string, KernelCode>& kernels) {
  const std::vector<Section> sections = sections_of(elf);
  std::map<std::string, KernelCode> raw;
  for (const Section& s : sections) {
    if (s.name.starts_with(text_prefix)) raw[std::string(s.name.substr(text_prefix.size()))].code = s.bytes;
    if (s.name.starts_with(constant_prefix))
      raw[std::string(s.name.substr(constant_prefix.size()))].constant = s.bytes.size();
  }
  for (const auto& [name, count] : registers_of(sections))
    if (const auto kernel = raw.find(name); kernel != raw.end()) kernel->second.registers = count;
  for (auto& [name, kernel] : raw) kernels[without_own_namespace(name)] = std::move(kernel);
}

}  // namespace

std::map<std::string, KernelCode> kernels_of(const std::filesystem::path& object) {
  const std::string bytes = read_text_file(object.string(), std::size_t{1} << 30, "an object file of nvcc");
  std::map<std::string, KernelCode> kernels;
  try {
    for (std::size_t at = bytes.find(ELFMAG); at != bytes.npos; at = bytes.find(ELFMAG, at + 1)) {
      const std::string_view rest = std::string_view(bytes).substr(at);
      if (rest.size() < sizeof(Elf64_Ehdr)) break;
      if (read<Elf64_Ehdr>(rest, 0).e_machine == EM_CUDA) add_kernels(rest, kernels);
    }
  } catch (const InputError& error) {
    throw InputError(object.string() + ": " + error.what());
  }
  if (kernels.empty())
    throw InputError(object.string() + ": holds no machine code that is not compressed (nvcc --no-compress)");
  return kernels;
}

}  // namespace collidoscope
