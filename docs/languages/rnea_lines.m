% Answers every line of numbers with a line of numbers, by rnea.m, in Octave. To judge it:
%
%     graphdyn export ur5 --to model.m
%     graphdyn judge ur5 --command 'inverse_dynamics=octave-cli rnea_lines.m' --restart-after 1000
%
% --restart-after is needed because fgetl reads ahead to the next line before it returns this one.

robot = model();
line = fgetl(stdin);
while ischar(line)
  x = reshape(str2double(strsplit(line, ' ')), [], 3);          % q, v, a
  printf('%.17g ', rnea(robot, x(:, 1), x(:, 2), x(:, 3)));     % for a matrix M write M': Octave stores columns first
  printf('\n');
  fflush(stdout);
  line = fgetl(stdin);
end
