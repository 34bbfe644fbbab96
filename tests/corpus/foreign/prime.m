syms x
x = x'; f = [x -x; x];
h = {x}; p = [1 2