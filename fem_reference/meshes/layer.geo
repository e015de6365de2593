// One period of the layer, 1 by 1/2, with two contact edges on its face; triangles graded towards them.
// layer.msh: gmsh -2 -format msh41 layer.geo
edge_size = 0.004;
face_size = 0.08;
plate_size = 0.12;
Point(1) = {0, 0, 0, face_size};
Point(2) = {0.3, 0, 0, edge_size};
Point(3) = {0.7, 0, 0, edge_size};
Point(4) = {1, 0, 0, face_size};
Point(5) = {1, 0.5, 0, plate_size};
Point(6) = {0, 0.5, 0, plate_size};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Periodic Curve {4} = {-6};
Physical Curve("face") = {1, 2, 3};
Physical Curve("right") = {4};
Physical Curve("plate") = {5};
Physical Curve("left") = {6};
Physical Surface("layer") = {1};
