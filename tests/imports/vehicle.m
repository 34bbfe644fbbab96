% A quarter of a car on its spring, over a road that nobody knows:
% states are the deflections of spring and tyre and the two velocities.
% After R. Rajamani, Vehicle Dynamics and Control, Springer (2012), chapter 10
clear; close all

syms zs vs zt vt real    % spring, body, tyre, wheel
syms ks ms mu            % the tyre's stiffness kt is known
syms bs kt F road drag
x = [zs; vs; zt; vt];
p = [ks, bs, ms, mu].';
u = F;                   % the actuator
w = road;                % the slope of the road, as it comes

drag = 0.5*abs(vs)*vs;   % of the air
f = [vs - vt;
     (-ks*zs - bs*(vs - vt) + F - drag)./ms;
     vt - road;
     (ks.*zs + bs*(vs - vt) ...
        - kt*zt - F)/mu];

h = [zs zt 2^-1*vs];
ics = [0, 0, 0, 0];
known_ics = [1 0 0 1];
save('vehicle', 'x', 'p', 'h', 'f', 'u', 'w', 'ics', 'known_ics');
