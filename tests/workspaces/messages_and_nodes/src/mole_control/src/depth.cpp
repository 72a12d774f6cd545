#include <iostream>

#include "mole_control/depth.hpp"

int main()
{
  std::cout << mole::depth_after(4.0) << std::endl;
  return 0;
}
