#include <exception>
#include <iostream>

#include "tests/acceptance/recording.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: recording_to_capture IN.txt OUT.pcap\n"
                 "turns a text file with one RSI telegram a line into a capture\n";
    return 2;
  }
  try {
    std::cout << acceptance::recording_to_capture(argv[1], argv[2]) << " telegrams\n";
  } catch (const std::exception& problem) {
    std::cerr << "recording_to_capture: " << problem.what() << '\n';
    return 1;
  }
  return 0;
}
