// A chuck of silicon carbide, 240 x 240 x 14 mm: four pockets from below, three holes for lift pins.
//     gmsh -parse_and_exit chuck.geo        writes chuck.step
SetFactory("OpenCASCADE");
Geometry.OCCTargetUnit = "MM";
Box(1) = {-120, -120, -14, 240, 240, 14};
n = 10;
For i In {0:1}
  For j In {0:1}
    Box(n) = {-112 + 115 * i, -112 + 115 * j, -14, 109, 109, 9};
    n += 1;
  EndFor
EndFor
For k In {0:2}
  Cylinder(n) = {60 * Cos(2 * Pi * k / 3 + Pi / 4), 60 * Sin(2 * Pi * k / 3 + Pi / 4), -14, 0, 0, 14, 6};
  n += 1;
EndFor
BooleanDifference{ Volume{1}; Delete; }{ Volume{10:n-1}; Delete; }
Save "chuck.step";
