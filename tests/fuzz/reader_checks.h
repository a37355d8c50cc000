#pragma once
// Properties that hold for any input of a reader, for the fuzzers and for the test that reads their corpora.
// A text is read, or refused by an InputError whose lines begin with the file's name. A text that was read is
// valid, and writing and reading it again gives the same result. Each function throws std::logic_error on a
// violation.

#include <functional>
#include <string>

namespace collidoscope {

/// Returns whether `read` succeeded. A refusal must be an InputError whose lines begin with the file's name.
bool reads(const std::string& file, const std::function<void()>& read);

void check_scene(const std::string& text);
/// Checks changes of changed_scene(): three bodies, a generator and a joint.
void check_changes(const std::string& text);
/// Checks the bytes as they are, and with the correct size and hash, so that the reader reaches the data
/// after them.
void check_snapshot(const std::string& bytes);
/// Checks the bytes as they are, and with the correct hashes of all chunks.
void check_recording(const std::string& bytes);
/// Checks a criterion of changed_scene(), and one of a scene that was not readable.
void check_criterion(const std::string& text);
void check_object(const std::string& text);
/// Checks an array, and its boxes if it has any.
void check_npy(const std::string& bytes);
void check_tree(const std::string& bytes);
/// Checks a table of bodies of any format.
void check_table(const std::string& bytes);
/// Checks the text as URDF and as MJCF.
void check_robot(const std::string& text);

/// A scene as file text.
std::string changed_scene();

}  // namespace collidoscope
