% Writes the files of `forms` beside this script: one small study of five conditions in the forms that GNU Octave saves.
%
% Run as `octave-cli make_study_forms.m` in this folder. The study is that of `file_forms.rs`: the identified models are the physics
% models with known gains and delays of each channel, in other units and another order, NZ turned.

1;

function model = physics_model(k)
  model.A = [-1 - 0.1*k, 0.2, 0, 0.1; -0.3, -2 - 0.05*k, 0.4, 0; 0.1, 0, -0.8, 0.5; 0, 0.2, -0.6, -1.5];
  model.B = [2, 0.3, 0.1; 0.2, 3 + 0.1*k, 0; 0.1, 0, 1.5; 0, 0.4, 0.5];
  model.C = [0.2, 1, 0.1, 0; 1, 0.1, 0, 0.2; 0.1, 0, 1, 0.4];
  model.D = [0, 0, 0; 0, 0, 0; 0, 0, 0.2];
  model.InputName = {'LON'; 'LAT'; 'COL'};
  model.InputUnit = {'%'; '%'; '%'};
  model.OutputName = {'P'; 'Q'; 'NZ'};
  model.OutputUnit = {'deg/s'; 'deg/s'; 'm/s^2'};
  model.airspeed_kt = 40 + 20*k;
  model.condition = k + 1;
end

function model = identified_model(k)
  model = physics_model(k);
  input_gains = [1 + 0.05*k, 0.9 + 0.02*k, 1.1 - 0.03*k];
  output_gains = [0.95 + 0.03*k, 1.05 - 0.02*k, 1.2 - 0.04*k];
  % How many of the dataset's units one of the file's is: inches, percent, fractions; rad/s, rad/s, g, positive down.
  input_factors = [8, 1, 100];
  output_factors = [180/pi, 180/pi, -9.80665];
  inputs = [3, 2, 1];
  outputs = [3, 2, 1];
  into = diag(input_gains .* input_factors)(:, inputs);
  from = diag(output_gains ./ output_factors)(outputs, :);
  model.B = model.B * into;
  model.C = from * model.C;
  model.D = from * model.D * into;
  model.InputName = {'COL'; 'LAT'; 'xb'};
  model.InputUnit = {'fraction'; '%'; 'in'};
  model.OutputName = {'-NZ'; 'Q'; 'roll rate'};
  model.OutputUnit = {'g'; 'rad/s'; 'rad/s'};
  model.InputDelay = [0.01, 0.02, 0.015](inputs);
  model.OutputDelay = [0.005, 0, 0.01](outputs);
end

save_header_format_string('# Created by GNU Octave');
folder = fullfile(fileparts(mfilename('fullpath')), 'forms');
for role = {'nominal', 'identified'}
  models = [];
  for k = 0:4
    if strcmp(role{1}, 'nominal')
      models = [models, physics_model(k)];
    else
      models = [models, identified_model(k)];
    end
  end
  save('-text', fullfile(folder, 'text', [role{1}, '.txt']), 'models');
  save('-binary', fullfile(folder, 'binary', [role{1}, '.bin']), 'models');
  packed = fullfile(folder, 'hdf5', [role{1}, '.h5']);
  save('-hdf5', packed, 'models');
  gzip(packed);
  delete(packed);
  save('-v7', fullfile(folder, 'v7', [role{1}, '.mat']), 'models');
end
