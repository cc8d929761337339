% Reads questions from a file and writes the answers of rnea.m, in Octave and MATLAB. To run and judge it:
%
%     graphdyn export ur5 --to model.m
%     graphdyn questions ur5 --for inverse_dynamics --out questions.csv
%     octave-cli rnea_file.m
%     graphdyn judge ur5 --answers answers.csv

robot = model();
n = robot.n;
questions = fopen('questions.csv');
answers = fopen('answers.csv', 'w');
fgetl(questions);                                        % the header
line = fgetl(questions);
while ischar(line)
  cells = strsplit(line, ',');                           % id, name of the function, q, v, a
  x = str2double(cells(3:end))';
  tau = rnea(robot, x(1:n), x(n + 1:2 * n), x(2 * n + 1:3 * n));
  fprintf(answers, '%s', cells{1});
  fprintf(answers, ',%.17g', tau);                       % for a matrix M write M': Octave stores columns first
  fprintf(answers, '\n');
  line = fgetl(questions);
end
fclose(questions);
fclose(answers);
