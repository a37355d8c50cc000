// Reads NumPy archives (.npz) with libzip.

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/binary_rows.h"
#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/npy.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/import/text_rows.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_arrays = 1000;
/// An array may have this many bytes, or more if it is not compressed to less than 1/100: no small file takes
/// much memory.
constexpr std::size_t unsuspicious_bytes = std::size_t{1} << 30;
constexpr std::size_t highest_ratio = 100;

/// Names of an array with three columns.
struct VectorName {
  std::string_view names, columns[3];
};
constexpr VectorName vector_names[] = {
    {" position positions pos points coordinates coords center centers ", {"x", "y", "z"}},
    {" velocity velocities vel linearvelocity ", {"vx", "vy", "vz"}},
    {" angularvelocity angularvelocities omega spin ", {"wx", "wy", "wz"}}};

class NpzArchive {
 public:
  explicit NpzArchive(const std::string& name) : name_(name), archive_(nullptr, &zip_discard) {
    const InputFile file(name, "a NumPy archive (.npz)");  // reports a missing file
    int code = 0;
    archive_.reset(zip_open(name.c_str(), ZIP_RDONLY, &code));
    if (archive_ == nullptr) {
      zip_error_t error;
      zip_error_init_with_code(&error, code);
      const std::string why = zip_error_strerror(&error);
      zip_error_fini(&error);
      throw InputError(fmt::format("{}: damaged archive ({}), expected a file of numpy.savez", name, why));
    }
  }

  struct Member {
    std::string name;
    zip_uint64_t index;
    std::size_t bytes;
  };
  std::vector<Member> members() const {
    std::vector<Member> all;
    const auto count =
        static_cast<zip_uint64_t>(std::max<zip_int64_t>(0, zip_get_num_entries(archive_.get(), 0)));
    if (count > most_arrays)
      throw InputError(fmt::format("{}: {} arrays, expected at most {}", name_, count, most_arrays));
    for (zip_uint64_t index = 0; index < count; ++index) {
      zip_stat_t stat;
      zip_stat_init(&stat);
      constexpr zip_uint64_t needed = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE;
      if (zip_stat_index(archive_.get(), index, 0, &stat) != 0 || (stat.valid & needed) != needed)
        throw InputError(fmt::format("{}: array {} is damaged", name_, index));
      std::string_view name = stat.name;
      if (!name.ends_with(".npy")) continue;
      name.remove_suffix(4);
      if (stat.size > std::max<zip_uint64_t>(unsuspicious_bytes, stat.comp_size * highest_ratio))
        throw InputError(
            fmt::format("{}: {} has {} bytes, compressed to {}; expected at most {}, or less "
                        "compression",
                        name_, shown_text(name), stat.size, stat.comp_size, unsuspicious_bytes));
      all.push_back({std::string(name), index, static_cast<std::size_t>(stat.size)});
    }
    return all;
  }

  NpyArray read(const Member& member) const {
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> stream(
        zip_fopen_index(archive_.get(), member.index, 0), &zip_fclose);
    const std::string whole_name = fmt::format("{}: {}.npy", name_, shown_text(member.name));
    if (stream == nullptr)
      throw InputError(fmt::format("{}: cannot be read ({})", whole_name, zip_strerror(archive_.get())));
    return read_npy(whole_name, member.bytes, [&](void* to, std::size_t bytes) {
      for (std::size_t done = 0; done < bytes;) {
        const zip_int64_t got = zip_fread(stream.get(), static_cast<char*>(to) + done, bytes - done);
        if (got <= 0) return false;
        done += static_cast<std::size_t>(got);
      }
      return true;
    });
  }

 private:
  std::string name_;
  std::unique_ptr<zip_t, void (*)(zip_t*)> archive_;
};

/// The names of an array's columns.
std::vector<std::string> column_names(const std::string& name, std::size_t columns) {
  if (columns == 1) return {name};
  const std::string padded = " " + plain_name(name) + " ";
  std::vector<std::string> names;
  for (const VectorName& vector : vector_names)
    if (columns == 3 && vector.names.find(padded) != std::string_view::npos)
      names.assign(std::begin(vector.columns), std::end(vector.columns));
  if (columns == 4 && (padded == " orientation " || padded == " quaternion " || padded == " orientations "))
    names = {"qw", "qx", "qy", "qz"};
  for (std::size_t k = names.size(); k < columns; ++k) names.push_back(fmt::format("{}[{}]", name, k));
  return names;
}

/// 0: not an array with a row for each body.
std::size_t columns_of(const NpyArray& array) {
  constexpr std::size_t most_columns = 64;
  if (array.shape.size() == 1) return 1;
  return array.shape.size() == 2 && array.shape[1] <= most_columns ? array.shape[1] : 0;
}

/// That of the positions, else of the longest array.
std::optional<std::size_t> number_of_bodies(const std::vector<NpzArchive::Member>& members,
                                            const std::vector<NpyArray>& arrays) {
  std::optional<std::size_t> longest;
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    const std::size_t columns = columns_of(arrays[k]);
    if (columns == 0) continue;
    if (column_names(members[k].name, columns)[0] == "x") return arrays[k].shape[0];
    longest = std::max(longest.value_or(0), arrays[k].shape[0]);
  }
  return longest;
}

}  // namespace

BodyTable read_npz_bodies(const std::string& file, const TableOptions& options) {
  const NpzArchive archive(file);
  struct Source {
    NpyArray array;
    std::size_t columns, first;
  };
  std::vector<Source> sources;
  std::vector<std::string> names, unused;
  const std::vector<NpzArchive::Member> members = archive.members();
  std::vector<NpyArray> arrays;
  for (const NpzArchive::Member& member : members) arrays.push_back(archive.read(member));
  const std::optional<std::size_t> rows = number_of_bodies(members, arrays);
  for (std::size_t k = 0; rows && k < members.size(); ++k) {
    const std::size_t columns = columns_of(arrays[k]);
    // Other arrays, such as a time, are not of bodies.
    if (columns == 0 || arrays[k].shape[0] != *rows) {
      unused.push_back(fmt::format("{} {}", shown_text(members[k].name), shape_text(arrays[k].shape)));
      continue;
    }
    const std::vector<std::string> own = column_names(members[k].name, columns);
    sources.push_back({std::move(arrays[k]), columns, names.size()});
    names.insert(names.end(), own.begin(), own.end());
  }
  if (!rows) throw InputError(file + ": no arrays of bodies, expected position (n, 3) and radius (n)");
  const auto number_at = [&](std::size_t row, std::size_t column) {
    const auto after = std::ranges::upper_bound(sources, column, {}, &Source::first);
    const Source& source = *(after - 1);
    const bool fortran = source.array.fortran_order;
    const std::size_t place =
        row * (fortran ? 1 : source.columns) + (column - source.first) * (fortran ? *rows : 1);
    return source.array.visit([&](const auto* numbers) { return static_cast<double>(numbers[place]); });
  };
  if (options.preview != nullptr) {
    preview_numbers(*options.preview, names, names.size(), *rows, number_at);
    return {};
  }
  const ColumnChoice choice = choose_columns(options.columns, names, names.size(), file);
  BodyTableBuilder table(choice, *rows, options.scale, file);
  const std::vector<ColumnTarget> targets = table.targets(names.size());
  for (const Source& source : sources) {
    const std::vector<ColumnTarget> own(
        targets.begin() + static_cast<std::ptrdiff_t>(source.first),
        targets.begin() + static_cast<std::ptrdiff_t>(source.first + source.columns));
    const bool fortran = source.array.fortran_order;
    const std::size_t row_step = fortran ? 1 : source.columns, column_step = fortran ? *rows : 1;
    source.array.visit([&](const auto* numbers) {
      store_rows(*rows, own, fmt::format("{}: {}", file, names[source.first]),
                 [&](std::size_t row, std::size_t column) {
                   return static_cast<double>(numbers[row * row_step + column * column_step]);
                 });
    });
  }
  BodyTable bodies = table.finish(names, names.size());
  for (const std::string& array : unused)
    bodies.notes.push_back(fmt::format("array not used: {}, expected {} rows", array, *rows));
  return bodies;
}

}  // namespace collidoscope
