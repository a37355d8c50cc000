// Reading machine code: a cubin made by hand, inside of other bytes, as an object file holds it.

#include "headless/bench/machine_code.h"

#include <elf.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <vector>

#include "sim_cuda/core/error.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

template <class Record>
std::string bytes_of(const Record& record) {
  return std::string(reinterpret_cast<const char*>(&record), sizeof record);
}

/// An ELF file for CUDA with one kernel of `registers` registers and 16 bytes of constants.
std::string cubin(const std::string& kernel, const std::string& code, std::uint32_t registers) {
  const std::string symbol_names = std::string(1, '\0') + kernel + '\0';
  Elf64_Sym none{}, symbol{};
  symbol.st_name = 1;
  const std::uint8_t form = 4, number = 0x2f, other = 0x11;
  const std::uint16_t size = 8;
  const std::uint32_t index = 1, nothing = 0;
  const auto record = [&](std::uint8_t what, std::uint32_t value) {
    return bytes_of(form) + bytes_of(what) + bytes_of(size) + bytes_of(index) + bytes_of(value);
  };
  struct Part {
    std::string name, bytes;
    std::uint32_t type, link;
  };
  std::vector<Part> parts{{"", "", SHT_NULL, 0},
                          {".shstrtab", "", SHT_STRTAB, 0},
                          {".strtab", symbol_names, SHT_STRTAB, 0},
                          {".symtab", bytes_of(none) + bytes_of(symbol), SHT_SYMTAB, 2},
                          {".nv.info", record(other, nothing) + record(number, registers), SHT_LOPROC, 0},
                          {".text." + kernel, code, SHT_PROGBITS, 0},
                          {".nv.constant0." + kernel, std::string(16, '\0'), SHT_PROGBITS, 0}};
  std::string names;
  std::vector<Elf64_Shdr> headers(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    headers[k].sh_name = static_cast<Elf64_Word>(names.size());
    names += parts[k].name + '\0';
  }
  parts[1].bytes = names;
  std::string body;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    headers[k].sh_type = parts[k].type;
    headers[k].sh_link = parts[k].link;
    headers[k].sh_offset = sizeof(Elf64_Ehdr) + body.size();
    headers[k].sh_size = parts[k].bytes.size();
    body += parts[k].bytes;
  }
  Elf64_Ehdr header{};
  std::memcpy(header.e_ident, ELFMAG, SELFMAG);
  header.e_machine = EM_CUDA;
  header.e_shoff = sizeof header + body.size();
  header.e_shnum = static_cast<Elf64_Half>(parts.size());
  header.e_shstrndx = 1;
  std::string file = bytes_of(header) + body;
  for (const Elf64_Shdr& each : headers) file += bytes_of(each);
  return file;
}

std::string written(const TemporaryFolder& folder, const std::string& bytes) {
  const std::string path = (folder.path() / "stage.o").string();
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

TEST(MachineCode, IsFoundInsideOfAnObject) {
  const TemporaryFolder folder;
  const auto kernels = kernels_of(written(folder,
                                          "\x7f"
                                          "EL no header" +
                                              cubin("move", "machine code", 37) + "and more"));
  ASSERT_EQ(kernels.size(), 1u);
  EXPECT_EQ(kernels.at("move"), (KernelCode{"machine code", 37, 16}));
  EXPECT_NE(kernels.at("move"), (KernelCode{"machine code", 38, 16}));
  EXPECT_NE(kernels.at("move"), (KernelCode{"machine cope", 37, 16}));
}

TEST(MachineCode, NamesOfAFilesOwnNamespaceAreThoseOfTheNextCompilation) {
  const TemporaryFolder folder;
  // Of 49 and of 48 letters: the number at its end is that of the compiler's process.
  const auto one = kernels_of(written(
      folder, cubin("_ZN3runIN49_GLOBAL__N__577b6110_8_move_cpp_00b3271d_58562341E4StepEEvT_", "x", 1)));
  const auto two = kernels_of(written(
      folder, cubin("_ZN3runIN48_GLOBAL__N__11112222_8_move_cpp_00b3271d_5856234E4StepEEvT_", "x", 1)));
  EXPECT_EQ(one, two);
}

TEST(MachineCode, SaysWhatIsWrongWithAFile) {
  const TemporaryFolder folder;
  EXPECT_THROW(kernels_of(folder.path() / "missing.o"), InputError);
  EXPECT_THROW(kernels_of(written(folder, "nothing of the kind")), InputError);
  const std::string whole = cubin("move", "machine code", 37);
  for (std::size_t kept = 0; kept < whole.size(); ++kept)
    EXPECT_THROW(kernels_of(written(folder, whole.substr(0, kept))), InputError) << kept;
}

}  // namespace
}  // namespace collidoscope
