#include "mole_control/depth.hpp"

int main() {return mole::depth_after(0.0) > 0.0;}
