#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orbifit {

/// Arrays in numpy's archive format (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html): a zip of
/// .npy files, stored.
class NpzArchive {
 public:
  void add(const std::string& name, const std::vector<std::size_t>& shape, const std::vector<std::int32_t>& values);
  void add(const std::string& name, const std::vector<std::size_t>& shape, const std::vector<double>& values);

  /// The file's bytes. \throw InputError where it had more than 4 GB
  std::string bytes() const;

 private:
  template <class Number>
  void add_array(const std::string& name, const char* type, const std::vector<std::size_t>& shape,
                 const std::vector<Number>& values);

  struct Member {
    std::string name, content;
  };
  std::vector<Member> members_;
};

}  // namespace orbifit
