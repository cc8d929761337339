% Compares a function with a file of test vectors, in Octave and MATLAB. To run it:
%
%     graphdyn vectors ur5 --out vectors
%     graphdyn export ur5 --to model.m
%     octave-cli vectors.m

robot = model();
arguments = 3 * robot.n;
rows = dlmread('vectors/inverse_dynamics.csv', ',', 1, 0);   % without the header
numbers = (size(rows, 2) - arguments) / 2;
failed = 0;
for k = 1:size(rows, 1)
  x = reshape(rows(k, 1:arguments), [], 3);                  % q, v, a
  answer = rnea(robot, x(:, 1), x(:, 2), x(:, 3));           % for a matrix M: reshape(M', [], 1), row by row
  expected = rows(k, arguments + (1:numbers))';
  tolerance = rows(k, arguments + numbers + (1:numbers))';
  failed = failed + ~all(abs(answer - expected) <= tolerance);   % NaN is wrong
end
fprintf('inverse_dynamics: %d rows fail\n', failed);
exit(failed ~= 0);
