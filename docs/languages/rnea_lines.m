% rnea.m as a program that answers a line of numbers with a line of numbers, in Octave, after
%
%     graphdyn export ur5 --to model.m
%     graphdyn judge ur5 --command 'inverse_dynamics=octave-cli rnea_lines.m' --restart-after 1000
%
% --restart-after, since fgetl looks at the next line before it returns this one.

robot = model();
line = fgetl(stdin);
while ischar(line)
  x = reshape(str2double(strsplit(line, ' ')), [], 3);          % q, v, a
  printf('%.17g ', rnea(robot, x(:, 1), x(:, 2), x(:, 3)));     % of a matrix M: M', since columns come first here
  printf('\n');
  fflush(stdout);
  line = fgetl(stdin);
end
