% Writes a state-space model for gdcm: one file a model, in a folder named by its condition.
%
%   export_models(sys, 'models/c03_045kt_high/roll+5.mat')
%
% No such script is needed for ss, idss, tf, zpk, frd and idfrd objects saved by `save`: gdcm reads them as they are, and structs
% and plain matrices A, B, C, D too. It is for objects that gdcm names as not readable.
function export_models(sys, file)
[A, B, C, D] = ssdata(sys);
Ts = sys.Ts;
InputName = sys.InputName;
OutputName = sys.OutputName;
InputUnit = sys.InputUnit;
OutputUnit = sys.OutputUnit;
InputDelay = sys.InputDelay;
OutputDelay = sys.OutputDelay;
StateName = {};
if isprop(sys, 'StateName')
  StateName = sys.StateName;
end
save(file, 'A', 'B', 'C', 'D', 'Ts', 'InputName', 'OutputName', 'InputUnit', 'OutputUnit', 'InputDelay', 'OutputDelay', 'StateName');
end
